// The radio between the two spacecraft at its worst.

#include <algorithm>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "fsw/gnc/gnc.h"
#include "tests/integration/experiment3/flight.h"
#include "tests/support/figures.h"

namespace vbar::test {
namespace {

constexpr int kPropagated = telemetry_navigation::kSourcePropagated, kFixed = telemetry_navigation::kSourceGnssFixed;

TEST(Crosslink, AFifthLostAndFiveSecondsLateCostLessThanHalf) {
  const std::vector<std::string> poor{"links.crosslink.latency={distribution=\"uniform\", min_s=0.0, max_s=5.0}",
                                      "links.crosslink.loss_probability=0.2"};
  std::vector<double> usual, worse;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    usual.push_back(fly_experiment3(seed).mean_position_m);
    const Flight flight = fly_experiment3(seed, poor);
    worse.push_back(flight.mean_position_m);
    EXPECT_LT(flight.first_fix_s.value_or(1e9), 300.0) << seed;
    for (const int index : {9, 10}) EXPECT_LT(waypoint(flight.flown.record, index).control_error_m, 0.05) << seed;
  }
  fmt::print("mean position error {:.2f} mm, {:.2f} mm over a poor crosslink\n", 1e3 * accuracy::median(usual),
             1e3 * accuracy::median(worse));
  EXPECT_LT(accuracy::median(worse), 1.5 * accuracy::median(usual));
}

class Silence : public ::testing::TestWithParam<int> {};
// Before the planner begins, between the waypoints while burns are flown, and across waypoint 9.
INSTANTIATE_TEST_SUITE_P(From_s, Silence, ::testing::Values(600, 1800, 3300));

TEST_P(Silence, OfTenMinutesIsCoastedToldAndRecoveredFrom) {
  constexpr double kSilence_s = 600.0;
  const double begin_s = GetParam();
  const Flight flight = fly_experiment3(
      1, {fmt::format("links.crosslink.silence_begin_s={}", begin_s),
          fmt::format("links.crosslink.silence_duration_s={}", kSilence_s), "guidance.navigation_timeout_s=300.0"});
  const report::RunRecord& record = flight.flown.record;
  const double start_s = record.truth.front().time_s;
  accuracy::Smallest fixed_again_s;
  accuracy::Largest largest_m;
  for (std::size_t k = 0; k < record.estimates.size(); ++k) {
    const report::EstimateRow& estimate = record.estimates[k];
    const double since_s = estimate.time_s - start_s - begin_s;
    double error_m = 0.0, variance = 0.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      error_m = std::hypot(error_m, estimate.relative_position_rtn[axis] - record.truth[k].relative_position_rtn[axis]);
      variance += estimate.sigma_rtn[axis] * estimate.sigma_rtn[axis];
    }
    // A measurement counts as fresh for 30 s, and two steps pass before the last one is folded in.
    if (since_s >= 60.0 && since_s < kSilence_s) {
      EXPECT_EQ(estimate.navigation_source, kPropagated) << since_s;
      EXPECT_EQ(estimate.navigation_valid, 1) << since_s;
      EXPECT_LT(error_m, 4.0 * std::sqrt(variance)) << since_s;  // it knows how much it has lost
      largest_m.add(error_m);
    }
    if (since_s >= kSilence_s && estimate.navigation_source == kFixed) {
      fixed_again_s.add(since_s - kSilence_s);
    }
  }
  fmt::print("silent from {} s: coasts to {:.1f} cm, fixed again after {:.0f} s\n", begin_s, 1e2 * largest_m,
             fixed_again_s);
  EXPECT_LT(fixed_again_s, 120.0);
  const std::vector<telemetry_health> health = telemetry_of<telemetry_health>(flight.flown);
  ASSERT_FALSE(health.empty());
  EXPECT_NE(health.back().faults & vbar::telemetry_health::kFaultNavigationTimeout, 0);
  EXPECT_LT(waypoint(record, 10).control_error_m, 0.05);
  EXPECT_LT(waypoint(record, 10).navigation_error_m.value_or(1e9), 0.02);
}

}  // namespace
}  // namespace vbar::test
