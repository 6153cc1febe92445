#include "host_sim/engine/controlled_wall_clock.h"

#include <optional>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace vbar::engine {

namespace {

using fsw::GpsTime;
using namespace std::chrono_literals;
using Kind = PaceRequest::Kind;

class TestWall final : public WallClock {
 public:
  Span now() override { return now_; }
  void sleep_until(Span wake) override {
    if (wake > now_) pass(wake - now_);
  }
  void pass(Span span) { now_ += span; }

 private:
  Span now_{12345ns};
};

/// A run in real time with steps of 60 s and requests that come at stated times of the wall.
class ControlledRun : public testing::Test {
 protected:
  using Requests = std::vector<std::pair<WallClock::Span, PaceRequest>>;

  void start(double speed_factor, Requests requests) {
    auto next = [this, requests = std::move(requests), k = std::size_t{0}]() mutable -> std::optional<PaceRequest> {
      if (k == requests.size() || passed() < requests[k].first) return std::nullopt;
      return requests[k++].second;
    };
    wall_clock_.emplace(wall_, speed_factor, std::move(next), [this] { return passed() > 1h; });
    ClockSettings settings;
    settings.mode = ClockMode::kRealTime;
    settings.speed_factor = speed_factor;
    clock_.emplace(settings, *wall_clock_);
    clock_->start(GpsTime{});
  }

  bool step(std::int64_t s) {
    const auto since_start = fsw::duration_of_seconds(s);
    if (!clock_->begin_step(GpsTime{} + since_start, [this] { return passed() > 1h; })) return false;
    wall_.pass(work);
    wall_clock_->step_has_passed(since_start);
    return true;
  }
  bool event(std::int64_t s) {
    return clock_->wait_until(GpsTime{} + fsw::duration_of_seconds(s), nullptr, [this] { return passed() > 1h; });
  }

  /// On the wall.
  [[nodiscard]] WallClock::Span passed() { return wall_.now() - begin_; }
  [[nodiscard]] std::uint64_t all_lateness() const {
    const DeadlineReport& report = clock_->report();
    return report.step_late.count + report.link_late.count + report.woke_late.count + report.simulation_late.count;
  }

  WallClock::Span work{0};  ///< of the computer in each step

 private:
  TestWall wall_;
  WallClock::Span begin_ = wall_.now();
  std::optional<ControlledWallClock> wall_clock_;
  std::optional<RunClock> clock_;
};

TEST_F(ControlledRun, APauseDelaysWhatFollowsAndIsNoLateness) {
  start(10.0, {{2s, {Kind::kPause}}, {9s, {Kind::kGoOn}}});
  ASSERT_TRUE(step(0));
  ASSERT_TRUE(step(60));
  EXPECT_EQ(passed(), 13s) << "6 s of flight, 7 s of pause";
  ASSERT_TRUE(step(120));
  EXPECT_EQ(passed(), 19s);
  EXPECT_EQ(all_lateness(), 0U);
}

TEST_F(ControlledRun, ANewSpeedHoldsFromThePresentOn) {
  start(10.0, {{2s, {Kind::kNone, 20.0}}});
  ASSERT_TRUE(step(0));
  ASSERT_TRUE(step(60));  // 20 s of flight in 2 s, 40 s in 2 s
  EXPECT_EQ(passed(), 4s);
  ASSERT_TRUE(step(120));
  EXPECT_EQ(passed(), 7s);
  EXPECT_EQ(all_lateness(), 0U);
}

TEST_F(ControlledRun, OneStepPassesAPauseWithTheEventsBeforeIt) {
  start(1.0, {{0s, {Kind::kPause}}, {5s, {Kind::kStep}}});
  ASSERT_TRUE(event(30));
  ASSERT_TRUE(step(60));
  EXPECT_EQ(passed(), 5s);
  EXPECT_FALSE(event(61)) << "paused again, until it is stopped";
}

TEST_F(ControlledRun, ALateRunIsPausedTooAndGoesOnWithoutItsLateness) {
  work = 50s;
  start(10.0, {{100s, {Kind::kPause}}, {130s, {Kind::kGoOn}}});
  ASSERT_TRUE(step(0));
  ASSERT_TRUE(step(60));  // due at 6 s, begins at 50 s
  ASSERT_TRUE(step(120));
  EXPECT_EQ(passed(), 186s) << "6 s after it went on, and the work of the step";
}

TEST_F(ControlledRun, ASlowerSpeedHoldsAtOnceInARunThatIsAsFastAsItCan) {
  work = 1s;
  start(1e6, {{2s, {Kind::kNone, 10.0}}});
  ASSERT_TRUE(step(0));
  ASSERT_TRUE(step(60));
  ASSERT_TRUE(step(120));
  EXPECT_EQ(passed(), 9s) << "6 s of flight, and the work of the step";
}

}  // namespace

}  // namespace vbar::engine
