#include <algorithm>
#include <random>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "host_sim/engine/clock.h"
#include "host_sim/engine/event_queue.h"

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

namespace {

constexpr fsw::GpsTime at_second(std::int64_t s) {
  return fsw::GpsTime{1'000'000'000} + fsw::duration_of_seconds(s);
}
constexpr fsw::Duration every(std::int64_t s) {
  return fsw::duration_of_seconds(s);
}

TEST(Cadence, BeginsOnePeriodAfterItsFirstPart) {
  const Cadence cadence(at_second(0), every(60));
  EXPECT_EQ(cadence.next_after(at_second(-500)), at_second(60));
  EXPECT_EQ(cadence.next_after(at_second(59)), at_second(60));
  EXPECT_EQ(cadence.next_after(at_second(60)), at_second(120));
  EXPECT_EQ(cadence.next_at(at_second(60)), at_second(60));
}

TEST(Cadence, ThePeriodChangesAtTheTimeOfTheNextPart) {
  const Cadence cadence({{at_second(0), every(60)}, {at_second(150), every(20)}, {at_second(200), every(5)}});
  std::vector<fsw::GpsTime> epochs;
  for (fsw::GpsTime time = at_second(0); time < at_second(205); time = epochs.back())
    epochs.push_back(cadence.next_after(time));
  const std::vector<fsw::GpsTime> expected{at_second(60), at_second(120), at_second(170), at_second(190),
                                           at_second(205)};
  EXPECT_EQ(epochs, expected) << "an epoch beyond the next part would not be of its part";
  EXPECT_EQ(cadence.shortest_period(), every(5));
}

TEST(Cadence, TheBeginningOfAPartIsTheLastEpochBeforeIt) {
  const Cadence cadence({{at_second(0), every(60)}, {at_second(120), every(5)}});
  EXPECT_EQ(cadence.next_after(at_second(60)), at_second(120));
  EXPECT_EQ(cadence.next_after(at_second(120)), at_second(125));
}

TEST(Cadence, NumbersAreThoseOfCounting) {
  const Cadence cadence({{at_second(0), every(60)}, {at_second(150), every(20)}, {at_second(200), every(7)}});
  std::int64_t number = 0;
  for (fsw::GpsTime time = cadence.next_after(at_second(0)); time < at_second(400); time = cadence.next_after(time))
    EXPECT_EQ(cadence.number_of(time), number++) << time.ns;
  EXPECT_EQ(cadence.number_of(at_second(0)), 0);
}

TEST(Cadence, RefusesWhatHasNoOrder) {
  EXPECT_THROW(Cadence(std::vector<Cadence::Part>{}), std::invalid_argument);
  EXPECT_THROW(Cadence(at_second(0), every(0)), std::invalid_argument);
  EXPECT_THROW(Cadence({{at_second(0), every(1)}, {at_second(0), every(2)}}), std::invalid_argument);
}

}  // namespace

namespace {

using fsw::Status;

TEST(EventQueue, OrdersByTimeThenPriorityThenInsertion) {
  EventQueue<char> queue(GpsTime{0});
  ASSERT_TRUE(queue.schedule(GpsTime{20}, 0, 'e').ok());
  ASSERT_TRUE(queue.schedule(GpsTime{10}, 1, 'c').ok());
  ASSERT_TRUE(queue.schedule(GpsTime{10}, 1, 'd').ok());
  ASSERT_TRUE(queue.schedule(GpsTime{10}, -1, 'b').ok());
  ASSERT_TRUE(queue.schedule(GpsTime{5}, 9, 'a').ok());
  std::string order;
  while (const auto entry = queue.pop()) order += entry->event;
  EXPECT_EQ(order, "abcde");
}

// The order is that of a stable sort by (time, priority), whatever order the events were scheduled in.
TEST(EventQueue, AgreesWithAStableSortOfManyRandomEvents) {
  struct Event {
    std::int64_t time;
    std::int32_t priority;
    int number;
  };
  std::mt19937 generator(7);
  std::vector<Event> events;
  EventQueue<int> queue(GpsTime{0});
  for (int k = 0; k < 2000; ++k) {
    const Event event{static_cast<std::int64_t>(generator() % 50), static_cast<std::int32_t>(generator() % 5) - 2, k};
    events.push_back(event);
    ASSERT_TRUE(queue.schedule(GpsTime{event.time}, event.priority, event.number).ok());
  }
  std::stable_sort(events.begin(), events.end(), [](const Event& a, const Event& b) {
    return a.time != b.time ? a.time < b.time : a.priority < b.priority;
  });
  for (const Event& expected : events) {
    const auto entry = queue.pop();
    ASSERT_TRUE(entry.has_value());
    EXPECT_EQ(entry->event, expected.number);
  }
  EXPECT_TRUE(queue.empty());
}

TEST(EventQueue, CancelledEventDoesNotHappenAndCancelsOnce) {
  EventQueue<int> queue(GpsTime{0});
  const auto first = queue.schedule(GpsTime{1}, 0, 1);
  const auto second = queue.schedule(GpsTime{2}, 0, 2);
  ASSERT_TRUE(first.ok() && second.ok());
  EXPECT_TRUE(queue.cancel(first.value()));
  EXPECT_FALSE(queue.cancel(first.value()));
  const auto entry = queue.pop();
  ASSERT_TRUE(entry.has_value());
  EXPECT_EQ(entry->event, 2);
  EXPECT_FALSE(queue.cancel(second.value())) << "it has happened";
}

TEST(EventQueue, PresentFollowsTheEventsAndThePastIsClosed) {
  EventQueue<int> queue(GpsTime{100});
  EXPECT_EQ(queue.schedule(GpsTime{99}, 0, 1).status(), Status::kOutOfRange);
  ASSERT_TRUE(queue.schedule(GpsTime{100}, 0, 2).ok()) << "the present is not the past";
  ASSERT_TRUE(queue.schedule(GpsTime{150}, 0, 3).ok());
  EXPECT_EQ(queue.next_time(), GpsTime{100});
  ASSERT_TRUE(queue.pop().has_value());
  ASSERT_TRUE(queue.pop().has_value());
  EXPECT_EQ(queue.now(), GpsTime{150});
  EXPECT_EQ(queue.schedule(GpsTime{149}, 0, 4).status(), Status::kOutOfRange);
  EXPECT_FALSE(queue.next_time().has_value());
  EXPECT_FALSE(queue.pop().has_value());
}

// An event scheduled while its own instant is being worked off still happens at that instant, in its place.
TEST(EventQueue, EventsScheduledForThePresentHappenInPriorityOrder) {
  EventQueue<char> queue(GpsTime{0});
  ASSERT_TRUE(queue.schedule(GpsTime{1}, 0, 'a').ok());
  ASSERT_TRUE(queue.schedule(GpsTime{1}, 2, 'c').ok());
  ASSERT_EQ(queue.pop()->event, 'a');
  ASSERT_TRUE(queue.schedule(GpsTime{1}, 1, 'b').ok());
  EXPECT_EQ(queue.pop()->event, 'b');
  EXPECT_EQ(queue.pop()->event, 'c');
}

}  // namespace

}  // namespace vbar::engine
