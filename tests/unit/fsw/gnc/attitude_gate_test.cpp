// A star tracker in error against gyro and command.

#include "fsw/gnc/attitude_gate.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace vbar::fsw::gnc {
namespace {

const Vector3 kRate(0.0, 1e-3, 0.0);  // rad/s

Matrix3 turned(double angle) {
  return Eigen::AngleAxisd(angle, Vector3::UnitX()).toRotationMatrix();
}

class AttitudeGateTest : public ::testing::Test {
 protected:
  /// The true attitude, turned by an error about x.
  static navigation::AttitudeSample sample(std::int64_t s, double error = 0.0) {
    const Matrix3 R_eci_body =
        Eigen::AngleAxisd(kRate.y() * static_cast<double>(s), Vector3::UnitY()).toRotationMatrix();
    return {.time = GpsTime{} + duration_of_seconds(s), .R_eci_body = R_eci_body * turned(error), .rate_body = kRate};
  }
  static Matrix3 commanded(std::int64_t s) { return sample(s).R_eci_body.transpose(); }

  bool offer(const navigation::AttitudeSample& offered, const std::optional<Matrix3>& command) {
    const AttitudeGate::Verdict verdict = gate_.judge(offered, command);
    used_ = verdict.used;
    return verdict.is_accepted;
  }
  /// Of the attitude that was used in place of the last one offered, rad.
  double used_error() const {
    const auto s = static_cast<std::int64_t>(seconds(used_->time - GpsTime{}));
    return Eigen::AngleAxisd(Matrix3(used_->R_eci_body.transpose() * sample(s).R_eci_body)).angle();
  }

  AttitudeGate gate_;
  std::optional<navigation::AttitudeSample> used_;
};

constexpr double kStep = 0.01745;  // rad, of the tracker: 1 deg

TEST_F(AttitudeGateTest, ASteadyTrackerIsAccepted) {
  for (int s = 0; s < 100; s += 5) EXPECT_TRUE(offer(sample(s, 1e-4), commanded(s))) << s;
}

TEST_F(AttitudeGateTest, AStepOfOneDegreeIsRefusedForAsLongAsItLasts) {
  offer(sample(0), commanded(0));
  for (int s = 5; s < 900; s += 5) {
    EXPECT_FALSE(offer(sample(s, kStep), commanded(s))) << s;
    EXPECT_NEAR(gate_.difference(), kStep, 1e-6);
    ASSERT_TRUE(used_);
    EXPECT_LT(used_error(), 1e-6) << s;
  }
  EXPECT_TRUE(offer(sample(900), commanded(900)));
}

TEST_F(AttitudeGateTest, ASlewAwayFromTheCommandIsAcceptedByTheGyro) {
  for (int s = 0; s < 100; s += 5) EXPECT_TRUE(offer(sample(s), turned(1.0))) << s;
}

TEST_F(AttitudeGateTest, ANewCommandThatThePlatformFollowsAtOnceIsAccepted) {
  offer(sample(0), commanded(0));
  const navigation::AttitudeSample turned_by_command = sample(5, 0.5);
  EXPECT_TRUE(offer(turned_by_command, Matrix3(turned_by_command.R_eci_body.transpose())));
}

/// A step stays a step: the gyro continues through refusals, for as long as its drift is small.
TEST_F(AttitudeGateTest, WithoutACommandTheGyroJudgesForHalfAnHourAndThenNothing) {
  EXPECT_TRUE(offer(sample(0), std::nullopt));
  for (int s = 5; s <= 1800; s += 5) {
    EXPECT_FALSE(offer(sample(s, kStep), std::nullopt)) << s;
    ASSERT_TRUE(used_);
    EXPECT_LT(used_error(), 1e-6) << s;
  }
  EXPECT_TRUE(offer(sample(1805, kStep), std::nullopt));
}

TEST_F(AttitudeGateTest, WithoutACommandAGapEndsThePropagation) {
  EXPECT_TRUE(offer(sample(0), std::nullopt));
  EXPECT_FALSE(offer(sample(5, kStep), std::nullopt));
  EXPECT_TRUE(offer(sample(60, kStep), std::nullopt));
}

/// A platform that is not where it was commanded: its gyro is then more accurate.
TEST_F(AttitudeGateTest, APlatformThatControlsCoarselyIsReplacedByTheGyro) {
  constexpr double kControlError = 5e-3;  // rad
  const auto coarse = [](std::int64_t s) {
    return Matrix3((sample(s).R_eci_body * turned(-kControlError)).transpose());
  };
  EXPECT_TRUE(offer(sample(0), coarse(0)));
  EXPECT_FALSE(offer(sample(5, kStep), coarse(5)));
  ASSERT_TRUE(used_);
  EXPECT_LT(used_error(), 1e-6);
}

/// Stars of an image extend the refusal beyond what a gyro allows.
TEST_F(AttitudeGateTest, StarsRestartThePropagation) {
  EXPECT_TRUE(offer(sample(0), std::nullopt));
  for (int s = 5; s <= 4000; s += 5) {
    EXPECT_FALSE(offer(sample(s, kStep), std::nullopt)) << s;
    if (s % 1000 == 0) gate_.take_stars(sample(s).time, sample(s).R_eci_body);
  }
  EXPECT_TRUE(offer(sample(4005), std::nullopt));
}

/// A tracker that was in error from the first attitude on.
TEST_F(AttitudeGateTest, StarsContradictATrackerThatWasBelieved) {
  EXPECT_TRUE(offer(sample(0, kStep), std::nullopt));
  EXPECT_TRUE(offer(sample(5, kStep), std::nullopt));
  gate_.take_stars(sample(3).time, sample(3).R_eci_body);
  EXPECT_FALSE(offer(sample(10, kStep), std::nullopt));
  ASSERT_TRUE(used_);
  EXPECT_LT(used_error(), 1e-6);
}

}  // namespace
}  // namespace vbar::fsw::gnc
