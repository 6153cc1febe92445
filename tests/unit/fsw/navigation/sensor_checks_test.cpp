// A star tracker in error against gyro and command.

#include <memory>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "fsw/navigation/attitude_gate.h"
#include "fsw/navigation/receiver_watch.h"
#include "tests/unit/fsw/messaging/configurations.h"

namespace vbar::fsw::navigation {

namespace {

const Vector3 kRate(0.0, 1e-3, 0.0);  // rad/s

Matrix3 turned(double angle) {
  return Eigen::AngleAxisd(angle, Vector3::UnitX()).toRotationMatrix();
}

class AttitudeGateTest : public ::testing::Test {
 protected:
  /// The true attitude, turned by an error about x.
  static measurements::AttitudeSample sample(std::int64_t s, double error = 0.0) {
    const Matrix3 R_eci_body =
        Eigen::AngleAxisd(kRate.y() * static_cast<double>(s), Vector3::UnitY()).toRotationMatrix();
    return {.time = GpsTime{} + duration_of_seconds(s), .R_eci_body = R_eci_body * turned(error), .rate_body = kRate};
  }
  static Matrix3 commanded(std::int64_t s) { return sample(s).R_eci_body.transpose(); }

  bool offer(const measurements::AttitudeSample& offered, const std::optional<Matrix3>& command) {
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
  std::optional<measurements::AttitudeSample> used_;
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
  const measurements::AttitudeSample turned_by_command = sample(5, 0.5);
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

// Receivers that fall silent: the own one, and that of the target over the crosslink.

namespace {

using gnss::Receiver;

GpsTime at(int s) {
  return GpsTime{} + duration_of_seconds(1000 + s);
}

class ReceiverWatchTest : public ::testing::Test {
 protected:
  /// The faults that the step raised.
  std::int32_t step(int s, bool uses_crosslink = true) {
    faults_.clear(at(s), ~0);
    faults_.forget_transitions();
    watch_.update(at(s), *gnss_, uses_crosslink, faults_);
    std::int32_t raised = 0;
    for (const faults::Transition& transition : faults_.transitions()) raised |= transition.fault;
    return raised;
  }
  void hear(Receiver receiver, int s) { gnss_->hear(receiver, at(s)); }

  std::unique_ptr<gnss::GnssFrontEnd> gnss_ = std::make_unique<gnss::GnssFrontEnd>();
  faults::FaultMonitor faults_;
  ReceiverWatch watch_;
};

TEST_F(ReceiverWatchTest, AReceiverThatWasNeverHeardIsNotMissed) {
  for (int s = 0; s < 600; s += 10) EXPECT_EQ(step(s), 0);
}

TEST_F(ReceiverWatchTest, OneEpochAStepRaisesNothing) {
  for (int s = 0; s < 600; s += 10) {
    hear(Receiver::kServicer, s);
    hear(Receiver::kTarget, s);
    EXPECT_EQ(step(s), 0) << s;
  }
}

TEST_F(ReceiverWatchTest, StepsThatAreLongerThanAnEpoch) {
  for (int s = 0; s < 600; s += 60) {
    for (int epoch = 0; epoch < 60; epoch += 10) hear(Receiver::kServicer, s + epoch);
    EXPECT_EQ(step(s + 59), 0) << s;
  }
}

TEST_F(ReceiverWatchTest, SilenceOfTheOwnReceiverIsReportedAfterTwoEpochs) {
  for (int s = 0; s <= 100; s += 10) {
    hear(Receiver::kServicer, s);
    step(s);
  }
  EXPECT_EQ(step(110), 0);
  EXPECT_EQ(step(120), 0);
  EXPECT_EQ(step(125), telemetry_health::kFaultReceiverSilent);
  EXPECT_DOUBLE_EQ(faults_.transitions().front().argument, 25.0);
  hear(Receiver::kServicer, 130);
  EXPECT_EQ(step(130), 0);
}

TEST_F(ReceiverWatchTest, SilenceOfTheCrosslinkIsReportedAfterThirtySeconds) {
  for (int s = 0; s <= 100; s += 10) {
    hear(Receiver::kServicer, s);
    hear(Receiver::kTarget, s);
    step(s);
  }
  for (int s = 110; s <= 140; s += 10) {
    hear(Receiver::kServicer, s);
    const std::int32_t raised = step(s);
    EXPECT_EQ(raised, s <= 130 ? 0 : telemetry_health::kFaultCrosslinkSilent) << s;
  }
}

TEST_F(ReceiverWatchTest, ACrosslinkThatIsNotUsedIsNotMissed) {
  hear(Receiver::kTarget, 0);
  step(0, false);
  EXPECT_EQ(step(500, false), 0);
}

/// The packets of a gap were lost with it: the receiver is not to blame.
TEST_F(ReceiverWatchTest, AGapBetweenStepsIsNotSilence) {
  for (int s = 0; s <= 100; s += 10) {
    hear(Receiver::kServicer, s);
    step(s);
  }
  EXPECT_EQ(step(400), 0);
  hear(Receiver::kServicer, 405);
  EXPECT_EQ(step(410), 0);
}

}  // namespace

}  // namespace vbar::fsw::navigation
