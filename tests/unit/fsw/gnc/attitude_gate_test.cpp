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
    const bool is_accepted = gate_.accepts(offered, history_, command);
    if (is_accepted) history_.put(offered);
    return is_accepted;
  }

  AttitudeGate gate_;
  navigation::AttitudeHistory history_;
};

TEST_F(AttitudeGateTest, ASteadyTrackerIsAccepted) {
  for (int s = 0; s < 100; s += 5) EXPECT_TRUE(offer(sample(s, 1e-4), commanded(s))) << s;
}

TEST_F(AttitudeGateTest, AStepOfOneDegreeIsRefusedForAsLongAsItLasts) {
  offer(sample(0), commanded(0));
  for (int s = 5; s < 900; s += 5) {
    EXPECT_FALSE(offer(sample(s, 0.01745), commanded(s))) << s;
    EXPECT_NEAR(gate_.difference(), 0.01745, 1e-6);
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

TEST_F(AttitudeGateTest, WithoutACommandTheGyroJudgesAndThenNobody) {
  EXPECT_TRUE(offer(sample(0), std::nullopt));
  EXPECT_FALSE(offer(sample(5, 0.01745), std::nullopt));
  EXPECT_TRUE(offer(sample(60, 0.01745), std::nullopt)) << "the last attitude is too old to be propagated";
}

}  // namespace
}  // namespace vbar::fsw::gnc
