#include "fsw/faults/fault_monitor.h"

#include <gtest/gtest.h>

#include "fsw/faults/fault_table.h"

namespace vbar::fsw::fdir {

namespace {

constexpr std::int32_t kThruster = telemetry_health::kFaultThruster;  // two of two checks

GpsTime at(int s) {
  return GpsTime{} + duration_of_seconds(s);
}

TEST(FaultMonitor, AFaultIsRaisedOnceItPersistsWithAnEvent) {
  faults::FaultMonitor monitor;
  monitor.check(at(1), {.fault = kThruster, .is_detected = true});
  EXPECT_EQ(monitor.latched(), 0);
  monitor.check(at(2), {.fault = kThruster, .is_detected = true, .device = 8, .argument = 1.0});
  EXPECT_EQ(monitor.latched(), kThruster);
  EXPECT_EQ(monitor.present(), kThruster);
  EXPECT_EQ(monitor.onset(kThruster), at(2));
  ASSERT_EQ(monitor.transitions().size(), 1U);
  const faults::Transition& raised = monitor.transitions()[0];
  EXPECT_EQ(raised.fault, kThruster);
  EXPECT_EQ(raised.event, telemetry_event::kEventFaultRaised);
  EXPECT_EQ(raised.severity, telemetry_event::kSeverityFault);
  EXPECT_EQ(raised.device, 8);
  EXPECT_EQ(raised.argument, 1.0);
  EXPECT_EQ(raised.time, at(2));
}

TEST(FaultMonitor, AFaultThatEndsStaysLatchedWithItsFirstOnset) {
  faults::FaultMonitor monitor;
  for (int s = 1; s <= 2; ++s) monitor.check(at(s), {.fault = kThruster, .is_detected = true});
  for (int s = 3; s <= 4; ++s) monitor.check(at(s), {.fault = kThruster, .is_detected = false});
  EXPECT_EQ(monitor.latched(), kThruster);
  EXPECT_EQ(monitor.present(), 0);
  EXPECT_EQ(monitor.transitions().back().event, telemetry_event::kEventFaultEnded);
  for (int s = 5; s <= 6; ++s) monitor.check(at(s), {.fault = kThruster, .is_detected = true});
  EXPECT_EQ(monitor.onset(kThruster), at(2));
  EXPECT_EQ(monitor.present(), kThruster);
}

TEST(FaultMonitor, ClearingUnlatchesAndAFaultThatPersistsIsRaisedAgain) {
  faults::FaultMonitor monitor;
  for (int s = 1; s <= 2; ++s) monitor.check(at(s), {.fault = kThruster, .is_detected = true});
  monitor.forget_transitions();
  monitor.clear(at(3), ~0);
  EXPECT_EQ(monitor.latched(), 0);
  ASSERT_EQ(monitor.transitions().size(), 1U) << "only of the fault that was latched";
  EXPECT_EQ(monitor.transitions()[0].event, telemetry_event::kEventFaultCleared);
  for (int s = 4; s <= 5; ++s) monitor.check(at(s), {.fault = kThruster, .is_detected = true});
  EXPECT_EQ(monitor.latched(), kThruster);
  EXPECT_EQ(monitor.onset(kThruster), at(5));
}

TEST(FaultMonitor, ClearingOneLeavesTheOthers) {
  faults::FaultMonitor monitor;
  monitor.check(at(1), {.fault = telemetry_health::kFaultInboxFull, .is_detected = true});
  monitor.check(at(1), {.fault = telemetry_health::kFaultClock, .is_detected = true});
  monitor.clear(at(2), telemetry_health::kFaultClock);
  EXPECT_EQ(monitor.latched(), telemetry_health::kFaultInboxFull);
  EXPECT_EQ(monitor.present(), telemetry_health::kFaultInboxFull);
}

TEST(FaultMonitor, TheResponseIsThatOfTheTable) {
  faults::FaultMonitor monitor;
  EXPECT_FALSE(monitor.demands(faults::Response::kRetreat));
  monitor.check(at(1), {.fault = telemetry_health::kFaultGuardSilence, .is_detected = true});
  EXPECT_TRUE(monitor.demands(faults::Response::kRetreat));
  EXPECT_FALSE(monitor.demands(faults::Response::kHold));
  monitor.check(at(2), {.fault = telemetry_health::kFaultGuardSilence, .is_detected = false});
  EXPECT_FALSE(monitor.demands(faults::Response::kRetreat));
}

TEST(FaultMonitor, TransitionsWithoutAPlaceAreCounted) {
  faults::FaultMonitor monitor;
  for (int s = 0; s < 200; ++s)
    monitor.check(at(s), {.fault = telemetry_health::kFaultClock, .is_detected = s % 2 == 0});
  EXPECT_EQ(monitor.transitions().size() + static_cast<std::size_t>(monitor.lost_transitions()), 200U);
  EXPECT_GT(monitor.lost_transitions(), 0);
}

}  // namespace

namespace {

TEST(Persistence, RaisedByTheLimitWithinTheWindow) {
  faults::Persistence p(3, 5);
  EXPECT_FALSE(p.add(true));
  EXPECT_FALSE(p.add(false));
  EXPECT_FALSE(p.add(true));
  EXPECT_FALSE(p.add(false));
  EXPECT_TRUE(p.add(true));
}

TEST(Persistence, DetectionsOutsideTheWindowDoNotCount) {
  faults::Persistence p(2, 3);
  EXPECT_FALSE(p.add(true));
  EXPECT_FALSE(p.add(false));
  EXPECT_FALSE(p.add(false));
  EXPECT_FALSE(p.add(true));
}

TEST(Persistence, EndsWhenTheWholeWindowIsClear) {
  faults::Persistence p(1, 3);
  EXPECT_TRUE(p.add(true));
  EXPECT_TRUE(p.add(false));
  EXPECT_TRUE(p.add(false));
  EXPECT_FALSE(p.add(false));
}

TEST(Persistence, LargestWindow) {
  faults::Persistence p(64, 64);
  for (int k = 0; k < 63; ++k) EXPECT_FALSE(p.add(true)) << k;
  EXPECT_TRUE(p.add(true));
  for (int k = 0; k < 63; ++k) EXPECT_TRUE(p.add(false)) << k;
  EXPECT_FALSE(p.add(false));
}

TEST(Persistence, ResetForgetsEverything) {
  faults::Persistence p(2, 4);
  p.add(true);
  p.reset();
  EXPECT_FALSE(p.add(true));
  EXPECT_TRUE(p.add(true));
  p.reset();
  EXPECT_FALSE(p.is_persistent());
}

}  // namespace

}  // namespace vbar::fsw::fdir
