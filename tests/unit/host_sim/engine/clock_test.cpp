#include "host_sim/engine/clock.h"

#include <gtest/gtest.h>

namespace vbar::engine {
namespace {

using fsw::GpsTime;
using namespace std::chrono_literals;

/// A wall on which time passes only when somebody sleeps or the test says so.
class TestWall final : public WallClock {
 public:
  Span now() override { return now_; }
  void sleep_until(Span wake) override {
    ++sleeps;
    if (wake > now_) now_ = wake + oversleep;
  }
  void pass(Span span) { now_ += span; }

  Span oversleep{0};
  int sleeps = 0;

 private:
  Span now_{12345ns};
};

GpsTime at(std::int64_t seconds) {
  return GpsTime{} + fsw::duration_of_seconds(seconds);
}

ClockSettings real_time(double speed_factor) {
  ClockSettings settings;
  settings.mode = ClockMode::kRealTime;
  settings.speed_factor = speed_factor;
  settings.compute_budget = fsw::duration_of_seconds(4);
  settings.link_budget = fsw::duration_of_seconds(2);
  return settings;
}

TEST(RunClock, LockStepNeverWaitsAndBooksNoLateness) {
  TestWall wall;
  RunClock clock({}, wall);
  clock.start(at(0));
  for (int step = 0; step < 10; ++step) {
    EXPECT_TRUE(clock.begin_step(at(60 * step)));
    wall.pass(1000s);
    clock.end_exchange(1000s, 900s);
  }
  EXPECT_EQ(wall.sleeps, 0);
  EXPECT_EQ(clock.report().steps, 10U);
  EXPECT_EQ(clock.report().step_late.count, 0U);
  EXPECT_EQ(clock.report().link_late.count, 0U);
  EXPECT_EQ(clock.report().simulation_late.count, 0U);
}

TEST(RunClock, RealTimeIsPacedByTheSpeedFactor) {
  TestWall wall;
  const WallClock::Span begin = wall.now();
  RunClock clock(real_time(20.0), wall);
  clock.start(at(1000));
  EXPECT_TRUE(clock.begin_step(at(1000)));
  EXPECT_EQ(wall.now() - begin, 0ns);
  EXPECT_TRUE(clock.begin_step(at(1060)));
  EXPECT_EQ(wall.now() - begin, 3s);
  wall.pass(1s);  // work inside the step does not shift the schedule
  EXPECT_TRUE(clock.begin_step(at(1120)));
  EXPECT_EQ(wall.now() - begin, 6s);
  const DeadlineReport& report = clock.report();
  EXPECT_EQ(report.step_late.count + report.link_late.count + report.woke_late.count + report.simulation_late.count,
            0U);
}

class StartingWall final : public WallClock {
 public:
  Span now() override { return now_; }
  Span start_of_run() override { return 10s; }
  void sleep_until(Span wake) override { now_ = wake; }

 private:
  Span now_{4s};
};

TEST(RunClock, RunStartsWhenTheClockSaysSo) {
  StartingWall wall;
  RunClock clock(real_time(1.0), wall);
  clock.start(at(1000));
  EXPECT_TRUE(clock.begin_step(at(1000)));
  EXPECT_EQ(wall.now(), 10s);
  EXPECT_TRUE(clock.wait_until(at(1003), nullptr));
  EXPECT_EQ(wall.now(), 13s);
}

TEST(RunClock, LateWakingIsTheOperatingSystems) {
  TestWall wall;
  RunClock clock(real_time(1.0), wall);
  clock.start(at(0));
  ASSERT_TRUE(clock.begin_step(at(0)));
  wall.pass(9950ms);  // a single sleep is left, so the injected delay is the whole lateness
  wall.oversleep = 1ms;
  ASSERT_TRUE(clock.begin_step(at(10)));
  EXPECT_EQ(clock.report().woke_late.count, 0U) << "within the tolerance of 2 ms";
  wall.pass(9950ms);
  wall.oversleep = 30ms;
  ASSERT_TRUE(clock.begin_step(at(20)));
  EXPECT_EQ(clock.report().woke_late.count, 1U);
  EXPECT_EQ(clock.report().woke_late.worst, 30ms);
  EXPECT_EQ(clock.report().step_late.count + clock.report().link_late.count + clock.report().simulation_late.count, 0U);
}

TEST(RunClock, SlowComputingIsTheFlightComputersAndSlowTransferTheLinks) {
  TestWall wall;
  RunClock clock(real_time(2.0), wall);  // budgets on the wall: 2 s computing, 1 s link
  clock.start(at(0));
  ASSERT_TRUE(clock.begin_step(at(0)));
  clock.end_exchange(3s, 2s);
  EXPECT_EQ(clock.report().step_late.count + clock.report().link_late.count, 0U) << "both exactly at their budgets";
  clock.end_exchange(3100ms, 2100ms);
  EXPECT_EQ(clock.report().step_late.count, 1U);
  EXPECT_EQ(clock.report().step_late.worst, 100ms);
  EXPECT_EQ(clock.report().link_late.count, 0U);
  clock.end_exchange(2500ms, 1s);
  clock.end_exchange(2200ms, 1s);
  EXPECT_EQ(clock.report().step_late.count, 1U);
  EXPECT_EQ(clock.report().link_late.count, 2U);
  EXPECT_EQ(clock.report().link_late.worst, 500ms) << "the worst, not the last";
}

TEST(RunClock, DelayOfALateExchangeIsNotBookedAgain) {
  TestWall wall;
  RunClock clock(real_time(1.0), wall);
  clock.start(at(0));
  ASSERT_TRUE(clock.begin_step(at(0)));
  wall.pass(15s);
  clock.end_exchange(15s, 14s);
  ASSERT_TRUE(clock.begin_step(at(10)));  // 5 s behind, because of the exchange
  ASSERT_TRUE(clock.begin_step(at(12)));  // 3 s behind: catching up
  ASSERT_TRUE(clock.begin_step(at(20)));  // in time again
  EXPECT_EQ(clock.report().step_late.count, 1U);
  EXPECT_EQ(clock.report().simulation_late.count, 0U);
}

TEST(RunClock, OwnSlownessIsTheSimulations) {
  TestWall wall;
  RunClock clock(real_time(1.0), wall);
  clock.start(at(0));
  ASSERT_TRUE(clock.begin_step(at(0)));
  clock.end_exchange(1s, 1s);
  wall.pass(13s);  // say, rendering
  ASSERT_TRUE(clock.begin_step(at(10)));
  EXPECT_EQ(clock.report().simulation_late.count, 1U);
  EXPECT_EQ(clock.report().simulation_late.worst, 3s);
  EXPECT_EQ(clock.report().woke_late.count + clock.report().step_late.count + clock.report().link_late.count, 0U);
}

TEST(RunClock, WaitingEndsWhenAskedToStop) {
  TestWall wall;
  const WallClock::Span begin = wall.now();
  RunClock clock(real_time(1.0), wall);
  clock.start(at(0));
  int asked = 0;
  EXPECT_FALSE(clock.begin_step(at(3600), [&] { return ++asked == 5; }));
  EXPECT_LT(wall.now() - begin, 1s);
  EXPECT_EQ(clock.report().steps, 0U);
}

TEST(RunClock, EventsBetweenStepsArePacedToo) {
  TestWall wall;
  const WallClock::Span begin = wall.now();
  RunClock clock(real_time(2.0), wall);
  clock.start(at(0));
  Lateness late;
  EXPECT_TRUE(clock.wait_until(at(4), &late));
  EXPECT_EQ(wall.now() - begin, 2s);
  wall.pass(1500ms);
  EXPECT_TRUE(clock.wait_until(at(6), &late));  // due 0.5 s ago
  EXPECT_TRUE(clock.wait_until(at(6), nullptr));
  EXPECT_EQ(late.count, 1U);
  EXPECT_EQ(late.worst, 500ms);
  EXPECT_EQ(clock.report().steps, 0U);
  EXPECT_FALSE(clock.wait_until(at(100), &late, [] { return true; }));
}

TEST(RunClock, LockStepDoesNotWaitForEvents) {
  TestWall wall;
  RunClock clock({}, wall);
  clock.start(at(0));
  Lateness late;
  EXPECT_TRUE(clock.wait_until(at(3600), &late));
  EXPECT_EQ(wall.sleeps, 0);
  EXPECT_EQ(late.count, 0U);
  EXPECT_FALSE(clock.wait_until(at(3600), &late, [] { return true; })) << "asked to stop all the same";
}

TEST(RunClock, OversleepingForAnEventIsNotTheStepsSimulationLateness) {
  TestWall wall;
  RunClock clock(real_time(1.0), wall);
  clock.start(at(0));
  ASSERT_TRUE(clock.begin_step(at(0)));
  wall.pass(9950ms);
  wall.oversleep = 30ms;
  EXPECT_TRUE(clock.wait_until(at(10), nullptr));  // a measurement at the step's own time
  EXPECT_TRUE(clock.begin_step(at(10)));
  EXPECT_EQ(clock.report().woke_late.count, 1U);
  EXPECT_EQ(clock.report().simulation_late.count, 0U);
}

// The one test on the real clock: a wake-up never comes before its time.
TEST(SteadyWallClock, SleepsAtLeastAsLongAsAsked) {
  SteadyWallClock wall;
  const WallClock::Span wake = wall.now() + 5ms;
  wall.sleep_until(wake);
  EXPECT_GE(wall.now(), wake);
}

}  // namespace
}  // namespace vbar::engine
