// Decisions of a leg: keep, correct, replan, hand over.

#include "fsw/control/leg.h"

#include <cmath>

#include <gtest/gtest.h>

#include "fsw/orbit/roe.h"
#include "tests/unit/fsw/control/legs.h"

namespace vbar::fsw::control {
namespace {

namespace mission = orbit::mission;

// Leg 1 to 2, at its start.
LegSituation leg_start() {
  const mission::Waypoint& from = mission::kWaypoints[1];
  const orbit::QnsElements servicer = orbit::propagate_secular(mission::kServicerMean, from.time_h * 3600.0);
  LegSituation situation;
  situation.orbits = {{}, servicer, orbit::qns_from_roe(servicer, from.roe())};
  situation.earliest_burn = GpsTime{} + duration_of_seconds(10);
  situation.waypoint = {GpsTime{} + duration_of_seconds(21600), mission::kWaypoints[2].roe()};
  return situation;
}

LegDecision decided(const LegSituation& situation, const Plan& plan) {
  const Result<LegDecision> decision = decide_leg(situation, plan, {});
  EXPECT_TRUE(decision.ok());
  return decision.value();
}

// The same leg seen with the target's ROE changed by metres.
LegSituation shifted(LegSituation situation, int element, double metres) {
  Vector6 roe = orbit::roe_from_qns(situation.orbits.servicer, situation.orbits.target);
  roe[element] += metres / mission::kReferenceA;
  situation.orbits.target = orbit::qns_from_roe(situation.orbits.servicer, roe);
  return situation;
}

TEST(DecideLeg, PlansFirst) {
  const LegDecision first = decided(leg_start(), {});
  EXPECT_EQ(first.action, LegAction::kReplan);
  EXPECT_EQ(first.closed_form, Status::kOk);
  EXPECT_LT(mission::kReferenceA * first.error.norm(),
            0.05);                                  // Newton on the nonlinear prediction, from tens of metres
  EXPECT_NEAR(first.plan.total_dv(), 1.036, 0.02);  // the linear problem's solution; the nonlinear one differs by 1 %
}

TEST(DecideLeg, KeepsAPlanThatArrives) {
  const LegSituation start = leg_start();
  const Plan plan = decided(start, {}).plan;
  const LegDecision again = decided(shifted(start, 4, 0.5), plan);  // half a metre, tolerance one
  EXPECT_EQ(again.action, LegAction::kKeep);
  ASSERT_EQ(again.plan.count, plan.count);
  for (std::size_t k = 0; k < plan.count; ++k) EXPECT_EQ(again.plan.burns[k].dv_rtn, plan.burns[k].dv_rtn);
}

TEST(DecideLeg, CorrectsBurnsWhereTheyAre) {
  const LegSituation start = leg_start();
  const Plan plan = decided(start, {}).plan;
  const LegDecision decision = decided(shifted(start, 1, 20.0), plan);
  EXPECT_EQ(decision.action, LegAction::kCorrect);
  ASSERT_EQ(decision.plan.count, plan.count);
  for (std::size_t k = 0; k < plan.count; ++k) EXPECT_EQ(decision.plan.burns[k].time, plan.burns[k].time);
  EXPECT_LT(mission::kReferenceA * decision.error.norm(), 0.01);
  EXPECT_LT(decision.plan.total_dv(), 1.01 * plan.total_dv());
}

TEST(DecideLeg, ReplansWhatCannotBeCorrected) {
  const LegSituation start = leg_start();
  const Plan plan = decided(start, {}).plan;
  // Across the phase of the burns, the inclination vector needs other times.
  const LegDecision decision = decided(shifted(start, 4, 10.0), plan);
  EXPECT_EQ(decision.action, LegAction::kReplan);
  EXPECT_LT(mission::kReferenceA * decision.error.norm(), 0.05);
  EXPECT_NE(decision.plan.burns[0].time, plan.burns[0].time);
}

TEST(DecideLeg, HandsOverWhenBurnTimesRunOut) {
  LegSituation late = leg_start();
  late.waypoint.time = GpsTime{} + duration_of_seconds(2400);  // under half an orbit
  const LegDecision decision = decided(late, {});
  EXPECT_EQ(decision.action, LegAction::kHandOver);
  EXPECT_EQ(decision.closed_form, Status::kSingular);
  EXPECT_EQ(decision.plan.count, 0u);
}

TEST(DecideLeg, LeavesOutMissedBurns) {
  LegSituation start = leg_start();
  const Plan plan = decided(start, {}).plan;
  start.earliest_burn = plan.burns[0].time + duration_of_seconds(1);
  const LegDecision decision = decided(start, plan);
  for (const Burn& burn : decision.plan.all()) EXPECT_GE(burn.time, start.earliest_burn);
  EXPECT_NE(decision.action, LegAction::kKeep);
}

TEST(DecideLeg, ReportsAnEstimateThatIsNoOrbit) {
  LegSituation broken = leg_start();
  broken.orbits.target.a = std::nan("");
  EXPECT_FALSE(decide_leg(broken, {}, {}).ok());
}

TEST(KeepOrCorrect, NeverPlans) {
  const Result<LegDecision> decision = keep_or_correct(leg_start(), {}, {});
  ASSERT_TRUE(decision.ok());
  EXPECT_EQ(decision.value().action, LegAction::kHandOver);
  EXPECT_EQ(decision.value().closed_form, Status::kNotReady);
}

TEST(ArrivalSigma, GrowsAlongTrackWithTheUncertaintyOfDa) {
  LegSituation situation = leg_start();
  situation.sigma_roe[0] = 2.0 / mission::kReferenceA;
  situation.sigma_roe[1] = 3.0 / mission::kReferenceA;
  const Vector6 sigma_m = mission::kReferenceA * arrival_sigma(situation);
  // 1.58571e-3 m/s along track per metre of a da, over 6 h.
  EXPECT_NEAR(sigma_m[1], std::hypot(3.0, 2.0 * 1.58571e-3 * 21600.0), 0.02);
  EXPECT_NEAR(sigma_m[0], 2.0, 1e-9);
}

TEST(Arrives, WithinToleranceOrOneSigma) {
  LegSituation situation = leg_start();
  LegPolicy policy;
  policy.tolerance_m = 1.0;
  Vector6 error = Vector6::Zero();
  error[4] = 1.5 / mission::kReferenceA;
  EXPECT_FALSE(arrives(situation, error, policy));
  situation.sigma_roe[4] = 2.0 / mission::kReferenceA;
  EXPECT_TRUE(arrives(situation, error, policy));
  error[0] = 0.9 / mission::kReferenceA;  // 0.75 sigma and 0.9 tolerances: together too much
  EXPECT_FALSE(arrives(situation, error, policy));
}

}  // namespace
}  // namespace vbar::fsw::control
