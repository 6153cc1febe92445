// The retreat from the paper's last waypoints; figures of a separate implementation as in linear_drift_test.cpp.

#include "fsw/safety/retreat.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "fsw/orbit/roe.h"
#include "fsw/orbit/secular.h"
#include "fsw/safety/linear_drift.h"
#include "tests/support/figures.h"
#include "tests/unit/fsw/orbit/mission.h"

namespace vbar::fsw::safety {
namespace {

namespace mission = orbit::mission;

orbit::QnsElements servicer_at(double hours) {
  return orbit::propagate_secular(mission::kServicerMean, 3600.0 * hours);
}
orbit::QnsElements servicer_at_waypoint(std::size_t waypoint) {
  return servicer_at(mission::kWaypoints[waypoint].time_h);
}
Vector6 a_roe_of(std::size_t waypoint) {
  return Vector6(mission::kWaypoints[waypoint].a_roe_m.data());
}

/// The least distance after a burn, nominal and with both errors of either sign.
double distance_after(std::size_t waypoint, const Vector3& dv_rtn) {
  const auto servicer = servicer_at_waypoint(waypoint);
  const LinearDrift drift = LinearDrift::make(servicer, 86400.0).value();
  const Vector6 after = a_roe_of(waypoint) - servicer.a * orbit::roe_control_matrix(servicer) * dv_rtn;
  accuracy::Smallest least(drift.min_distance(after));
  for (const double sign : {-1.0, 1.0}) {
    least.add(drift.min_distance(after, {.a_da_m = 0.05 * sign, .differential_drag = 1e-9 * sign}));
  }
  return least;
}

TEST(Retreat, KnownBurnsKeepTheirDistance) {
  EXPECT_NEAR(distance_after(8, {0.0, -0.5e-3, 0.0}), 7.96, 0.05);
  EXPECT_NEAR(distance_after(9, {0.0, -0.3e-3, 0.0}), 5.38, 0.05);
  EXPECT_NEAR(distance_after(10, {0.0, -0.3e-3, 0.0}), 6.49, 0.05);
}

// Along track alone: a da afterwards is the recession, away from the target. (2/n per m/s is the whole effect.)
TEST(Retreat, TheRecedingBurnLeavesTheRecession) {
  for (std::size_t waypoint = 7; waypoint <= 10; ++waypoint) {
    const auto servicer = servicer_at_waypoint(waypoint);
    const RetreatBurn burn = find_retreat(servicer, a_roe_of(waypoint), {}).value();
    ASSERT_EQ(burn.choice, RetreatChoice::kReceding) << waypoint;
    EXPECT_TRUE(burn.keeps_distance);
    EXPECT_EQ(burn.dv_rtn(0), 0.0);
    EXPECT_EQ(burn.dv_rtn(2), 0.0);
    const Vector6 after = a_roe_of(waypoint) - servicer.a * orbit::roe_control_matrix(servicer) * burn.dv_rtn;
    EXPECT_NEAR(after(0), 1.0, 0.005) << "the target, behind, falls back further";
    EXPECT_LT(burn.dv_rtn.norm(), 5e-3);
  }
}

TEST(Retreat, OnTheOtherSideTheBurnIsReversed) {
  const auto servicer = servicer_at_waypoint(10);
  Vector6 a_roe = a_roe_of(10);
  const RetreatBurn behind = find_retreat(servicer, a_roe, {}).value();
  a_roe(1) = -a_roe(1);
  const RetreatBurn ahead = find_retreat(servicer, a_roe, {}).value();
  EXPECT_NEAR(ahead.dv_rtn(1), -behind.dv_rtn(1), 1e-12);
}

// Nobody acts after waypoint 8: 3.4 h later the target passes at 1.5 m. Before that the receding burn swings the target
// too close, and a burn of the menu does not.
TEST(Retreat, TheMenuIsSearchedWhereTheRecedingBurnIsTooClose) {
  int by_menu = 0;
  for (int minute = 150; minute < 205; ++minute) {
    const auto servicer = servicer_at(mission::kWaypoints[8].time_h + minute / 60.0);
    const Vector6 a_roe = orbit::roe_transition_j2(servicer_at_waypoint(8), 60.0 * minute) * a_roe_of(8);
    const auto burn = find_retreat(servicer, a_roe, {});
    ASSERT_TRUE(burn.ok());
    if (burn.value().choice != RetreatChoice::kMenu) continue;
    ++by_menu;
    ASSERT_TRUE(burn.value().keeps_distance);
    const LinearDrift drift = LinearDrift::make(servicer, 86400.0).value();
    const Vector6 after = a_roe - servicer.a * orbit::roe_control_matrix(servicer) * burn.value().dv_rtn;
    EXPECT_GE(drift.min_distance(after), 2.0);
    EXPECT_GE(drift.min_distance(after, {.a_da_m = -0.05, .differential_drag = -1e-9}), 2.0);
  }
  EXPECT_GT(by_menu, 0);
}

TEST(Retreat, WithoutAWayOutTheRecedingBurnIsStated) {
  Vector6 inside = Vector6::Zero();
  inside(1) = -0.5;
  const RetreatBurn burn = find_retreat(servicer_at(40.0), inside, {}).value();
  EXPECT_EQ(burn.choice, RetreatChoice::kReceding);
  EXPECT_FALSE(burn.keeps_distance);
  EXPECT_LT(burn.distance, 2.0);
}

TEST(Retreat, TheDelayContainsTheDriftUntilTheBurn) {
  // A da of 0.3 m brings the target from 2.4 m to below 2 m within the delay.
  Vector6 closing = Vector6::Zero();
  closing(0) = 0.3;
  closing(1) = 2.4;
  EXPECT_FALSE(find_delayed_retreat(servicer_at(40.0), closing, 1200.0, {}).value().burn.keeps_distance);
  const auto at_once = find_delayed_retreat(servicer_at_waypoint(9), a_roe_of(9), 0.0, {}).value().burn;
  const auto direct = find_retreat(servicer_at_waypoint(9), a_roe_of(9), {}).value();
  EXPECT_EQ(at_once.dv_rtn, direct.dv_rtn);
  EXPECT_EQ(at_once.distance, direct.distance);
}

TEST(Retreat, RefusesWhatIsNoSituation) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(find_retreat(servicer_at(40.0), Vector6::Constant(nan), {}).status(), Status::kNotFinite);
  EXPECT_EQ(find_delayed_retreat(servicer_at(40.0), a_roe_of(9), -1.0, {}).status(), Status::kOutOfRange);
  EXPECT_EQ(find_delayed_retreat(servicer_at(40.0), a_roe_of(9), nan, {}).status(), Status::kNotFinite);
}

}  // namespace
}  // namespace vbar::fsw::safety
