#include "hil_drivers/grand/pps/edge_clock.h"

#include <cmath>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include "hil_drivers/grand/pps/edge_source.h"
#include "tests/support/figures.h"

namespace vbar::grand {
namespace {

// A host's clock on which time passes only when somebody sleeps, and edges beside it.

using Span = engine::WallClock::Span;

class FakeHost final : public engine::WallClock {
 public:
  explicit FakeHost(Span& time) : time_(time) {}
  Span now() override { return time_; }
  void sleep_until(Span wake) override {
    if (wake > now()) time_ = wake;
  }

 private:
  Span& time_;
};

/// Edges become visible when the host's time has reached them.
class FakeEdges final : public EdgeSource {
 public:
  FakeEdges(const Span& time, std::deque<Edge>& edges) : time_(time), edges_(edges) {}
  std::optional<Edge> next(std::chrono::steady_clock::time_point /*deadline*/) override {
    if (edges_.empty() || (edges_.front().monotonic > time_ && !future_)) return std::nullopt;
    const Edge edge = edges_.front();
    edges_.pop_front();
    return edge;
  }
  [[nodiscard]] std::string description() const override { return "fake edges"; }
  bool future_ = false;

 private:
  const Span& time_;
  std::deque<Edge>& edges_;
};

using namespace std::chrono_literals;
using testing::AllOf;
using testing::HasSubstr;

constexpr std::int64_t kSecond_ns = 1'000'000'000;
constexpr fsw::GpsTime kFirstGps{1'000'000'000 * kSecond_ns};

std::string message_of(const std::function<void()>& act) {
  try {
    act();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "nothing was thrown";
}

/// A clock, edges and a host whose clock runs slow by `rate` against the edges.
class EdgeClockTest : public testing::Test {
 protected:
  static constexpr Span kStart = 5000s;

  [[nodiscard]] Span host_of(double edge_s) const { return kStart + Span(std::llround(edge_s / (1.0 + rate) * 1e9)); }
  void edge(double at_s, std::int64_t label_s) {
    edges.push_back({kFirstGps + fsw::duration_of_seconds(label_s), host_of(at_s), 0});
  }
  void edges_between(int first, int last) {
    for (int k = first; k <= last; ++k) edge(k, k);
  }
  EdgeClock make(const EdgeClockSettings& settings = {}) {
    return {std::make_unique<FakeEdges>(time, edges), std::make_unique<FakeHost>(time), settings};
  }
  void advance_to(double edge_s) {
    if (host_of(edge_s) > time) time = host_of(edge_s);
  }

  double rate = 50e-6;
  Span time = kStart;
  std::deque<Edge> edges;
};

TEST_F(EdgeClockTest, SleepsInTheTimeOfTheEdges) {
  edges_between(0, 300);
  EdgeClock clock = make();
  clock.wait_for_edges(100, 200s);
  for (int k = 101; k < 300; ++k) {
    clock.sleep_until(std::chrono::seconds(k) + 500ms);
    // The host alone would be off by 50 ppm of all that has passed: 15 ms.
    EXPECT_NEAR(std::chrono::duration<double>(time - host_of(k + 0.5)).count(), 0.0, 2e-6);
  }
  EXPECT_NEAR(clock.statistics().rate_error, 50e-6, 1e-7);
}

TEST_F(EdgeClockTest, KnowsTheGpsTimeOfItsEdges) {
  edges_between(0, 10);
  EdgeClock clock = make();
  EXPECT_FALSE(clock.gps_at(0s).has_value());
  clock.wait_for_edges(3, 10s);
  EXPECT_EQ(clock.gps_at(7s), kFirstGps + fsw::duration_of_seconds(7));
  EXPECT_EQ(clock.at_gps(kFirstGps + fsw::duration_of_seconds(7)), Span(7s));
}

TEST_F(EdgeClockTest, IsMonotonicWhenTheEdgesJumpBack) {
  edges_between(0, 20);
  for (int k = 21; k < 60; ++k) edge(k, k - 1);
  EdgeClock clock = make();
  clock.wait_for_edges(3, 10s);
  Span previous = clock.now();
  int halted = 0;
  for (double s = 3.0; s < 59.0; s += 0.1) {
    advance_to(s);
    const Span now = clock.now();
    ASSERT_GE(now, previous);
    halted += now == previous ? 1 : 0;
    previous = now;
  }
  EXPECT_NEAR(std::chrono::duration<double>(previous).count(), 58.9 - 1.0, 0.11);
  EXPECT_NEAR(halted, 10, 1);  // for the second by which the edges went back
  EXPECT_EQ(clock.statistics().jumps, 1U);
  EXPECT_EQ(clock.statistics().rejected, 2U);
}

TEST_F(EdgeClockTest, CountsWhatHappensToEdges) {
  rate = 0.0;
  edges_between(0, 99);
  edges_between(103, 120);  // 3 are missing
  edge(120.004, 120);       // doubled
  edge(121.002, 121);       // late by 2 ms
  edges_between(122, 200);
  EdgeClock clock = make();
  clock.wait_for_edges(3, 10s);
  clock.sleep_until(199s);
  clock.sleep_until(200s);
  const EdgeStatistics statistics = clock.statistics();
  EXPECT_EQ(statistics.edges, 100U + 18U + 2U + 79U);
  EXPECT_EQ(statistics.used, 100U + 18U + 79U);
  EXPECT_EQ(statistics.missing, 3U);
  EXPECT_EQ(statistics.doubled, 1U);
  EXPECT_EQ(statistics.rejected, 1U);
  EXPECT_EQ(statistics.jumps, 0U);
  EXPECT_NEAR(statistics.longest_silence_s, 4.0, 1e-6);
  EXPECT_LT(statistics.jitter_s, 1e-6);
  EXPECT_EQ(statistics.host_minus_edge_s.size(), 100U + 18U + 80U - 1U);
  accuracy::Largest largest_s;
  for (const double s : statistics.host_minus_edge_s) largest_s.add(std::abs(s));
  EXPECT_NEAR(largest_s, 2e-3, 1e-5);
}

TEST_F(EdgeClockTest, EndsAfterAMinuteWithoutEdges) {
  edges_between(0, 20);
  EdgeClock clock = make();
  clock.wait_for_edges(3, 10s);
  clock.sleep_until(79s);
  EXPECT_THAT(message_of([&] { clock.sleep_until(90s); }),
              AllOf(HasSubstr("fake edges"), HasSubstr("no usable edge of the 1PPS for 60 s"), HasSubstr("PPS line")));
  EXPECT_NEAR(std::chrono::duration<double>(time - host_of(80.0)).count(), 0.0, 0.11);
}

TEST_F(EdgeClockTest, APauseOfTheHostIsNotSilenceOfTheSource) {
  edges_between(0, 20);
  EdgeClock clock = make();
  clock.wait_for_edges(3, 10s);
  clock.sleep_until(20s);
  advance_to(100.0);  // stopped, and its edges were lost
  for (int k = 101; k < 110; ++k) edge(k, k);
  EXPECT_NO_THROW(clock.sleep_until(109s));
  EXPECT_EQ(clock.statistics().missing, 80U);
}

TEST_F(EdgeClockTest, ARestartWithAnotherScenarioEndsIt) {
  edges_between(0, 20);
  for (int k = 21; k < 40; ++k) edge(k, k - 7 * 86400);
  EdgeClock clock = make();
  clock.wait_for_edges(3, 10s);
  EXPECT_THAT(message_of([&] { clock.sleep_until(39s); }), HasSubstr("have jumped by -604800.000 s"));
}

TEST_F(EdgeClockTest, TimeStampsOfTheFutureAndOfLongAgoAreRejected) {
  rate = 0.0;
  edges_between(0, 10);
  EdgeClock clock(
      [&] {
        auto source = std::make_unique<FakeEdges>(time, edges);
        source->future_ = true;
        return source;
      }(),
      std::make_unique<FakeHost>(time), {});
  time = kStart + 10s;
  clock.now();
  edge(1e8, 11);
  edges.push_back({kFirstGps, 1s, 0});
  edge(11, 11);
  time = kStart + 11s;
  clock.now();
  EXPECT_EQ(clock.statistics().rejected, 2U);
  EXPECT_EQ(clock.statistics().used, 12U);
}

TEST_F(EdgeClockTest, SaysSoIfThereAreNoEdges) {
  EdgeClock clock = make();
  EXPECT_THAT(message_of([&] { clock.wait_for_edges(3, 5s); }),
              AllOf(HasSubstr("fake edges"), HasSubstr("0 usable edges"), HasSubstr("within 5 s, 3 are needed")));
}

TEST(PpsClock, IsAClockOfMissions) {
  // With the host's own timer as source of edges.
  EXPECT_EQ(kPpsClock.name, "pps");
  const auto clock = kPpsClock.make("timer");
  const Span now = clock->now();
  clock->sleep_until(now + 20ms);
  EXPECT_GE(clock->now(), now + 20ms);
  EXPECT_THAT(message_of([] { (void)kPpsClock.make("sundial"); }),
              HasSubstr("\"sundial\" is not a source of PPS edges"));
}

}  // namespace

// The kernel's interface for PPS devices, which pps_shim.c implements on /dev/null. Debian's ppstest reads the same
// shim in tests/peers/grand.

namespace {

using Clock = std::chrono::steady_clock;

class KernelEdgesTest : public testing::Test {
 protected:
  KernelEdgesTest() { ::setenv("VBAR_PPS_PERIOD_MS", "40", 1); }
  ~KernelEdgesTest() override {
    for (const char* name : {"VBAR_PPS_PERIOD_MS", "VBAR_PPS_NO_WAIT", "VBAR_PPS_NO_ASSERT"}) ::unsetenv(name);
  }
  static std::string refusal_of(const std::string& device) {
    try {
      (void)make_edge_source("kernel:" + device);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "nothing was thrown";
  }
  static void expect_edges() {
    const auto source = make_edge_source("kernel:/dev/null");
    const auto first = source->next(Clock::now() + 10s);
    ASSERT_TRUE(first);
    EXPECT_FALSE(first->gps);
    for (std::uint32_t k = 1; k <= 5; ++k) {
      const auto edge = source->next(Clock::now() + 10s);
      ASSERT_TRUE(edge);
      const auto late = Clock::now().time_since_epoch() - edge->monotonic;
      EXPECT_GE(late, -1ms);
      // The shim's edges are multiples of 40 ms; the difference of two clocks is read to much better than 1 ms.
      const std::uint32_t edges = edge->count - first->count;
      EXPECT_GE(edges, k);
      EXPECT_NEAR(std::chrono::duration<double>(edge->monotonic - first->monotonic).count(), 0.04 * edges, 1e-3);
    }
  }
};

TEST_F(KernelEdgesTest, StampsAreInMonotonicTime) {
  expect_edges();
}

TEST_F(KernelEdgesTest, ADeviceThatCannotWaitIsPolled) {
  ::setenv("VBAR_PPS_NO_WAIT", "1", 1);
  expect_edges();
}

TEST_F(KernelEdgesTest, ReturnsAtTheDeadline) {
  ::setenv("VBAR_PPS_PERIOD_MS", "100000000", 1);
  const auto source = make_edge_source("kernel:/dev/null");
  const auto begin = Clock::now();
  EXPECT_FALSE(source->next(begin + 150ms));
  EXPECT_GE(Clock::now() - begin, 150ms);
  EXPECT_FALSE(source->next(Clock::time_point{}));
}

TEST_F(KernelEdgesTest, OtherDevicesAreRefused) {
  EXPECT_THAT(refusal_of("/dev/zero"), HasSubstr("/dev/zero: this is not a PPS device"));
  EXPECT_THAT(refusal_of("/dev/no_pps"), HasSubstr("/dev/no_pps: opening the PPS device: No such file"));
  ::setenv("VBAR_PPS_NO_ASSERT", "1", 1);
  EXPECT_THAT(refusal_of("/dev/null"), HasSubstr("does not capture assert edges"));
}

}  // namespace

}  // namespace vbar::grand
