// Plans with missed burns, against truth: point mass and J2 integrated slowly, impulses on the servicer.

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "fsw/orbit/mean_osculating.h"
#include "fsw/orbit/propagate.h"
#include "fsw/orbit/roe.h"
#include "fsw/orbit/rtn.h"
#include "fsw/safety/linear_drift.h"
#include "fsw/safety/passive_safety.h"
#include "fsw/safety/retreat.h"
#include "tests/support/figures.h"
#include "tests/unit/fsw/orbit/mission.h"
#include "tests/unit/fsw/orbit/reference_orbit.h"

namespace vbar::fsw::safety {

namespace {

namespace mission = orbit::mission;
namespace reference = orbit::reference;
using control::Plan;
using orbit::CartesianState;
using orbit::QnsElements;

constexpr GpsTime kStart{995000000'000'000'000};
constexpr double kHorizon = 6000.0;  // s, an orbit and a bit

void add_burn(Plan& plan, std::int64_t second, const Vector3& dv_rtn) {
  plan.burns[plan.count++] = {.time = kStart + duration_of_seconds(second), .dv_rtn = dv_rtn};
}

Vector6 roe_of(double da, double dlambda, double dex, double dey, double dix, double diy) {
  Vector6 roe;
  roe << da, dlambda, dex, dey, dix, diy;
  return roe / mission::kReferenceA;
}

struct Truth {
  double least = std::numeric_limits<double>::infinity();
  double time = 0.0;
  std::size_t prefix = 0;
  accuracy::Largest farthest;
};

/// Least distance over all prefixes, the drift after each watched for the horizon and until the next burn, every 10 s.
Truth fly_all_prefixes(const Vector6& roe, const Plan& plan) {
  const auto state_of = [](const QnsElements& mean) {
    return orbit::cartesian_from_qns(orbit::osculating_from_mean(mean).value()).value();
  };
  CartesianState servicer = state_of(mission::kServicerMean);
  CartesianState target = state_of(orbit::qns_from_roe(mission::kServicerMean, roe));
  double now = 0.0;
  Truth truth;
  for (std::size_t prefix = 0; prefix <= plan.count; ++prefix) {
    const double next = prefix < plan.count ? seconds(plan.burns[prefix].time - kStart) : now;
    CartesianState s = servicer;
    CartesianState t = target;
    const double watched = std::max(kHorizon, next - now);
    for (double elapsed = 0.0; elapsed <= watched; elapsed += 10.0) {
      const double distance = (s.position_eci - t.position_eci).norm();
      truth.farthest.add(distance);
      if (distance < truth.least) truth = {distance, now + elapsed, prefix, truth.farthest};
      s = reference::fly(s, 10.0, 10.0);
      t = reference::fly(t, 10.0, 10.0);
    }
    if (prefix == plan.count) break;
    servicer = orbit::apply_impulse_rtn(reference::fly(servicer, next - now), plan.burns[prefix].dv_rtn);
    target = reference::fly(target, next - now);
    now = next;
  }
  return truth;
}

TEST(PlanSafety, SeesTheDriftThatAMissedBrakingBurnLeavesBehind) {
  // 1000 m behind the target on its orbit. A retrograde burn that lowers the orbit by 106 m gains 3 pi times that, 1000
  // m, in a revolution; a burn half a revolution later stops it. If that one is missed, the servicer arrives at the
  // target.
  const Vector6 roe = roe_of(0, 1000, 0, 0, 0, 0);
  const double dv = 0.5 * orbit::mean_motion(mission::kReferenceA) * 1000.0 / (3.0 * math::kPi);
  Plan plan;
  add_burn(plan, 600, {0.0, -dv, 0.0});
  add_burn(plan, 600 + 2963, {0.0, -dv, 0.0});
  const SafetyCriterion criterion{.keep_out_radius = 100.0, .horizon = kHorizon};

  const PlanSafety verdict = assess_plan(kStart, mission::kServicerMean, roe, plan, criterion).value();
  EXPECT_FALSE(verdict.safe);
  EXPECT_EQ(verdict.prefix, 1U);
  EXPECT_LT(verdict.min_distance, 10.0);            // J2 shifts the rendezvous by metres
  EXPECT_NEAR(verdict.time, 600.0 + 5926.0, 60.0);  // a revolution after the burn
  const Truth truth = fly_all_prefixes(roe, plan);
  EXPECT_EQ(truth.prefix, 1U);
  EXPECT_NEAR(truth.time, verdict.time, 30.0);
  EXPECT_NEAR(truth.least, verdict.min_distance,
              5.0);  // 0.6 (e + J2) of 1.4 km, and 1.7 m between truth's samples

  // Without the first burn nothing happens; the sign of a servicer's burn matters: prograde opens the distance.
  Plan none;
  EXPECT_TRUE(assess_plan(kStart, mission::kServicerMean, roe, none, criterion).value().safe);
  Plan prograde;
  add_burn(prograde, 600, {0.0, dv, 0.0});
  EXPECT_TRUE(assess_plan(kStart, mission::kServicerMean, roe, prograde, criterion).value().safe);
}

TEST(PlanSafety, AgreesWithTruthForEveryKindOfBurn) {
  struct Case {
    Vector6 roe;
    std::vector<std::pair<std::int64_t, Vector3>> burns;
  };
  const std::vector<Case> cases = {
      {roe_of(0, -200, 0, 30, 0, 30),
       {{300, {0.01, 0.02, 0.0}}, {2500, {0.0, -0.03, 0.02}}, {6000, {-0.02, 0.0, -0.03}}}},
      {roe_of(20, -1000, 0, 100, 0, -80), {{0, {0.0, 0.0, 0.1}}, {9000, {0.0, 0.05, 0.0}}}},
      {mission::kWaypoints[8].roe(), {{100, {1e-4, -2e-4, 3e-4}}, {1900, {-3e-4, 1e-4, 1e-4}}}},
      {mission::kWaypoints[3].roe(), {{50, {0.05, 0.3, -0.2}}, {3000, {0.0, -0.2, 0.2}}, {12000, {0.1, 0.1, 0.1}}}},
  };
  for (const Case& c : cases) {
    Plan plan;
    for (const auto& [second, dv] : c.burns) add_burn(plan, second, dv);
    const PlanSafety verdict = assess_plan(kStart, mission::kServicerMean, c.roe, plan, {.horizon = kHorizon}).value();
    const Truth truth = fly_all_prefixes(c.roe, plan);
    // The stated 0.6 (e + J2) of the largest separation, and what truth misses between its samples of 10 s.
    const double tolerance = 1.3e-3 * truth.farthest + 5e-3 * truth.least;
    EXPECT_NEAR(verdict.min_distance, truth.least, tolerance) << (mission::kReferenceA * c.roe).transpose();
    EXPECT_EQ(verdict.prefix, truth.prefix) << (mission::kReferenceA * c.roe).transpose();
  }
}

TEST(PlanSafety, WatchesUntilTheNextBurnHoweverLateItIs) {
  // Closing at 30 m of da: 280 m a revolution, so the pass comes after 3.5 revolutions, far beyond the horizon of one.
  const Vector6 roe = roe_of(30, 1000, 0, 0, 0, 0);
  Plan late;
  add_burn(late, 5 * 5934, {0.0, 1e-3, 0.0});
  const SafetyCriterion criterion{.keep_out_radius = 100.0, .horizon = kHorizon};
  const PlanSafety verdict = assess_plan(kStart, mission::kServicerMean, roe, late, criterion).value();
  EXPECT_FALSE(verdict.safe);
  EXPECT_EQ(verdict.prefix, 0U);
  EXPECT_NEAR(verdict.min_distance, 30.0, 3.0);  // passes at a da; 0.6 (e + J2) of 1.2 km
  EXPECT_NEAR(verdict.time, 3.5 * 5934.0, 0.05 * 5934.0);
}

TEST(PlanSafety, OfNoBurnsIsThatOfTheDrift) {
  const Vector6 roe = mission::kWaypoints[8].roe();
  const PlanSafety plan =
      assess_plan(kStart, mission::kServicerMean, roe, {}, {.keep_out_radius = 1.0, .horizon = kHorizon}).value();
  const DriftSafety drift = assess_drift(mission::kServicerMean, roe, kHorizon).value();
  // The plan carries the target as elements: ROE round to 2e-16, 1.5e-9 m.
  EXPECT_NEAR(plan.min_distance, drift.spatial.distance, 1e-8);
  EXPECT_NEAR(plan.min_rn_distance, drift.radial_normal.distance, 1e-8);
  EXPECT_NEAR(plan.time, drift.spatial.time, 1e-3);
  EXPECT_TRUE(plan.safe);
}

TEST(PlanSafety, UncertaintyCanFailAPlan) {
  const Vector6 roe = mission::kWaypoints[9].roe();
  SafetyCriterion criterion{.keep_out_radius = 0.8, .horizon = kHorizon};
  EXPECT_TRUE(assess_plan(kStart, mission::kServicerMean, roe, {}, criterion).value().safe);
  criterion.bound = {.radial_normal = 0.3, .along_track = 10.0, .along_track_rate = 0.0};
  const PlanSafety verdict = assess_plan(kStart, mission::kServicerMean, roe, {}, criterion).value();
  EXPECT_FALSE(verdict.safe);
  EXPECT_NEAR(verdict.min_distance, 0.7, 2e-3);  // the separation of 1 m, J2 turning de against di, less 0.3
}

// 100 m behind the target and lower by as much as gains 100 m in a revolution; the burn of the plan stops that drift.
TEST(PlanSafety, TheDriftThatAPlanLeavesDoesNotForbidIt) {
  constexpr double kDrift_m = 100.0;
  const double a_da_m = kDrift_m / (3.0 * math::kPi);
  const Vector6 roe = roe_of(a_da_m, kDrift_m, 0, 0, 0, 0);
  const Vector3 stop(0.0, 0.5 * orbit::mean_motion(mission::kReferenceA) * a_da_m, 0.0);
  Plan plan, late;  // by the second the target is reached before the burn
  add_burn(plan, 300, stop);
  add_burn(late, 7000, stop);
  SafetyCriterion criterion{.keep_out_radius = 50.0, .horizon = kHorizon};
  const auto is_safe = [&](const Plan& flown) {
    const PlanSafety verdict = assess_plan(kStart, mission::kServicerMean, roe, flown, criterion).value();
    return verdict.safe;
  };
  EXPECT_TRUE(is_safe(plan));
  EXPECT_LT(assess_plan(kStart, mission::kServicerMean, roe, plan, criterion).value().min_distance, 50.0)
      << "if the burn is missed";
  EXPECT_FALSE(is_safe({})) << "without a burn";
  EXPECT_FALSE(is_safe(late));
  criterion.retreat = RetreatCriterion{.settings = {.contact_distance = 2.0, .horizon = kHorizon}, .delay = 600.0};
  EXPECT_TRUE(is_safe(plan));
  EXPECT_FALSE(is_safe({})) << "without a burn";
  EXPECT_FALSE(is_safe(late));
  criterion.retreat->delay = 6000.0;  // a retreat in place of the missed burn comes too late
  EXPECT_FALSE(is_safe(plan));
}

TEST(PlanSafety, RefusesWhatIsNoPlan) {
  const Vector6 roe = mission::kWaypoints[8].roe();
  const SafetyCriterion criterion{.keep_out_radius = 1.0, .horizon = kHorizon};
  Plan plan;
  add_burn(plan, 100, Vector3::Zero());
  add_burn(plan, 50, Vector3::Zero());
  EXPECT_EQ(assess_plan(kStart, mission::kServicerMean, roe, plan, criterion).status(), Status::kInvalidArgument);
  plan = {};
  add_burn(plan, -1, Vector3::Zero());
  EXPECT_EQ(assess_plan(kStart, mission::kServicerMean, roe, plan, criterion).status(), Status::kInvalidArgument);
  plan = {};
  add_burn(plan, 100, Vector3::Constant(std::numeric_limits<double>::quiet_NaN()));
  EXPECT_EQ(assess_plan(kStart, mission::kServicerMean, roe, plan, criterion).status(), Status::kNotFinite);
  plan.count = control::kMaxBurns + 1;
  EXPECT_EQ(assess_plan(kStart, mission::kServicerMean, roe, plan, criterion).status(), Status::kInvalidArgument);
  plan = {};
  for (std::size_t k = 0; k < control::kMaxBurns; ++k) add_burn(plan, 10, Vector3::Zero());  // full, and all at once
  EXPECT_TRUE(assess_plan(kStart, mission::kServicerMean, roe, plan, criterion).ok());
}

}  // namespace

// The retreat from the paper's last waypoints; figures of a separate implementation as in passive_safety_test.cpp.

namespace {

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

// Without a burn after waypoint 8: 3.4 h later the target passes at 1.5 m. Before that the receding burn swings the
// target too close, and a burn of the menu does not.
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
