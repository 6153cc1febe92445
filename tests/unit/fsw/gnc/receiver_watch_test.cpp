// Receivers that fall silent: the own one, and that of the target over the crosslink.

#include "fsw/gnc/receiver_watch.h"

#include <memory>

#include <gtest/gtest.h>

#include "tests/unit/fsw/gnc/packet_factory.h"

namespace vbar::fsw::gnc {
namespace {

using sources::Receiver;

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

  std::unique_ptr<sources::GnssFrontEnd> gnss_ = std::make_unique<sources::GnssFrontEnd>();
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
}  // namespace vbar::fsw::gnc
