// Decisions of a leg: keep, correct, replan, hand over.

#include "fsw/control/leg.h"

#include <cmath>

#include <gtest/gtest.h>

#include "fsw/control/arrival.h"
#include "fsw/control/closed_form.h"
#include "fsw/orbit/mean_osculating.h"
#include "fsw/orbit/roe.h"
#include "fsw/orbit/rtn.h"
#include "host_sim/truth/earth/time_scales.h"
#include "host_sim/truth/truth_model.h"
#include "tests/support/figures.h"
#include "tests/support/paths.h"
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

// n a = 7.5042 km/s at a = 7078.139 km (mu = 398600.4418 km^3/s^2): a metre of an element costs 1.0602 mm/s on the next
// leg.
TEST(ExpectedCost, IsTheDeltaVAndTheWorthOfTheMiss) {
  LegSituation situation = leg_start();
  situation.orbits.servicer.a = mission::kReferenceA;
  LegPolicy policy;
  policy.miss_price = 5.0;
  Plan plan;
  plan.burns[plan.count++] = {.time = situation.earliest_burn, .dv_rtn = Vector3(0.0, 3e-3, -4e-3)};
  EXPECT_NEAR(expected_cost(situation, plan, Vector6::Zero(), policy), 5e-3, 1e-12);
  Vector6 error = Vector6::Zero();
  error[0] = 0.02 / mission::kReferenceA;
  error[5] = -0.03 / mission::kReferenceA;
  EXPECT_NEAR(expected_cost(situation, plan, error, policy), 5e-3 + 5.0 * 0.05 * 1.0602e-3, 1e-7);
}

// Of a normal variable of mean m and standard deviation s, |x| has the expectation s sqrt(2/pi) exp(-m^2/2s^2) +
// m erf(m/(s sqrt 2)) (Leone et al. 1961, the folded normal distribution): the worth of a correction is held against
// it.
TEST(ExpectedCost, ACorrectionThatTheEstimateCannotKnowIsWorthLittle) {
  LegSituation situation = leg_start();
  LegPolicy policy;
  policy.miss_price = 1.0;
  const double unit = orbit::mean_motion(situation.orbits.servicer.a) * situation.orbits.servicer.a;
  const double sigma = 0.1 / mission::kReferenceA;
  situation.sigma_roe[5] = sigma;  // diy, on which no other element depends, as they do on dix by J2
  for (const double ratio : {0.0, 0.3, 1.0, 3.0}) {
    Vector6 error = Vector6::Zero();
    error[5] = ratio * sigma;
    const double folded =
        sigma * (std::sqrt(2.0 / M_PI) * std::exp(-0.5 * ratio * ratio) + ratio * std::erf(ratio / std::sqrt(2.0)));
    const double worth = expected_cost(situation, {}, error, policy) / unit;
    EXPECT_GT(worth, 0.99 * folded);
    EXPECT_LT(worth, 1.26 * folded);  // sqrt(pi/2) at zero
  }
}

}  // namespace

// The nonlinear arrival prediction against integrated motion and against the maps it is made of.

namespace {

orbit::CartesianState state_of(const orbit::QnsElements& mean) {
  return orbit::cartesian_from_qns(orbit::osculating_from_mean(mean).value()).value();
}

MeanOrbits waypoint_zero(GpsTime epoch) {
  return {epoch, mission::kServicerMean, orbit::qns_from_roe(mission::kServicerMean, mission::kWaypoints[0].roe())};
}

TEST(MeanAfterImpulse, HasTheOsculatingImageOfTheImpulse) {
  for (const Vector3& dv : {Vector3(0.0, 1.0, 0.0), Vector3(1.0, 0.0, 0.0), Vector3(0.0, 0.0, -1.0),
                            Vector3(-0.3, 0.5, 0.9), Vector3(1e-5, -2e-5, 0.0), Vector3(0.0, 0.0, 0.0)}) {
    const Result<orbit::QnsElements> after = mean_after_impulse(mission::kServicerMean, dv);
    ASSERT_TRUE(after.ok());
    const orbit::CartesianState expected = orbit::apply_impulse_rtn(state_of(mission::kServicerMean), dv);
    const orbit::CartesianState reached = state_of(after.value());
    // 1e-12 of the orbit's size and speed.
    EXPECT_LT((reached.position_eci - expected.position_eci).norm(), 7e-6);
    EXPECT_LT((reached.velocity_eci - expected.velocity_eci).norm(), 7.5e-9);
  }
}

TEST(MeanAfterImpulse, ChangesTheRoeAsTheServicerNotAsTheTarget) {
  // a ROE after 1 m/s of the servicer, from zero, in exact two-body motion; m.
  struct Case {
    Vector3 dv;
    std::array<double, 6> a_roe_m;
  };
  for (const Case& c : {Case{{0, 1, 0}, {-1893.052, 0.017, -1890.075, 22.814, 0, 0}},
                        Case{{1, 0, 0}, {-0.092, 1887.963, 11.415, 944.975, 0, 0}},
                        Case{{0, 0, 1}, {-0.126, -0.001, -0.126, 0.004, -943.559, 11.398}}}) {
    const Result<orbit::QnsElements> after = mean_after_impulse(mission::kServicerMean, c.dv);
    ASSERT_TRUE(after.ok());
    const Vector6 a_roe = mission::kReferenceA * orbit::roe_from_qns(after.value(), mission::kServicerMean);
    // Mean elements differ by the Jacobian 1 + O(J2), up to 3 J2 (Re/a)^2 = 0.27 %, of 1893 m.
    EXPECT_LT(accuracy::largest_entry(a_roe - Vector6(c.a_roe_m.data())), 5.0);
  }
}

TEST(MeanAfterImpulse, RefusesWhatLeavesTheOrbit) {
  EXPECT_FALSE(mean_after_impulse(mission::kServicerMean, Vector3(0.0, 4000.0, 0.0)).ok());
  EXPECT_FALSE(mean_after_impulse(mission::kServicerMean, Vector3(0.0, std::nan(""), 0.0)).ok());
}

TEST(Fly, WithoutBurnsIsSecularMotionOfBoth) {
  const MeanOrbits start = waypoint_zero({});
  const Result<MeanOrbits> end = fly(start, {}, GpsTime{} + duration_of_seconds(21600));
  ASSERT_TRUE(end.ok());
  const Vector6 a_roe = mission::kReferenceA * orbit::roe_from_qns(end.value().servicer, end.value().target);
  // 2000 m below, dlambda grows by 2000 m x 1.58571e-3 /s to first order; second order adds 24 m after 6 h.
  EXPECT_NEAR(a_roe[1], -75000.0 + 2000.0 * 1.58571e-3 * 21600.0, 30.0);
  EXPECT_GT(std::abs(a_roe[1] - (-75000.0 + 2000.0 * 1.58571e-3 * 21600.0)),
            15.0);  // the linear transition would not do
  EXPECT_NEAR(a_roe[0], -2000.0, 1e-6);
}

// The integrated truth of a J2 Earth, both spacecraft, the servicer flying the burns of leg 0 to 1.
TEST(Fly, PredictsTheIntegratedArrivalToDecimetres) {
  truth::TruthSettings settings;
  settings.epoch = truth::gps_from_utc("2011-07-18T01:00:00Z");
  settings.gravity_degree = 2;
  settings.gravity_order = 0;
  settings.data_directory = vbar::tests::source_path("data");
  truth::TruthModel model(settings);
  const MeanOrbits start = waypoint_zero(settings.epoch);
  const std::size_t servicer = model.add_spacecraft("servicer", state_of(start.servicer));
  const std::size_t target = model.add_spacecraft("target", state_of(start.target));

  ControlProblem problem = legs::problem(legs::kFarLegs[0]);
  problem.start = settings.epoch;
  problem.arrival = settings.epoch + duration_of_seconds(21600);
  const Result<Plan> plan = solve_closed_form(problem);
  ASSERT_TRUE(plan.ok());
  for (const Burn& burn : plan.value().all()) {
    model.advance_to(burn.time);
    model.apply_impulse_rtn(servicer, burn.dv_rtn);
  }
  model.advance_to(problem.arrival);
  const auto mean = [&](std::size_t spacecraft) {
    return orbit::mean_from_osculating(orbit::qns_from_cartesian(model.state(spacecraft)).value()).value();
  };
  const Vector6 truth_roe = orbit::roe_from_qns(mean(servicer), mean(target));
  const Result<MeanOrbits> arrival = fly(start, plan.value().all(), problem.arrival);
  ASSERT_TRUE(arrival.ok());
  const Vector6 error_m =
      mission::kReferenceA * (orbit::roe_from_qns(arrival.value().servicer, arrival.value().target) - truth_roe);
  // First-order Brouwer theory predicts ROE at 50 km to 0.3 to 0.65 m in each of three elements after 6 h of free
  // drift, and three burns of half a metre a second add as much again. The linear prediction misses by 30 m.
  EXPECT_LT(error_m.norm(), 1.0);
}

TEST(Fly, RefusesBurnsOutOfOrderOrWindow) {
  const MeanOrbits start = waypoint_zero(GpsTime{} + duration_of_seconds(1000));
  const GpsTime until = GpsTime{} + duration_of_seconds(2000);
  const auto burn = [](std::int64_t s) { return Burn{GpsTime{} + duration_of_seconds(s), Vector3(0.0, 0.1, 0.0)}; };
  const std::array<Burn, 2> good{burn(1000), burn(2000)};
  EXPECT_TRUE(fly(start, good, until).ok());
  const std::array<Burn, 2> unordered{burn(1500), burn(1400)};
  EXPECT_EQ(fly(start, unordered, until).status(), Status::kInvalidArgument);
  const std::array<Burn, 1> early{burn(999)};
  EXPECT_EQ(fly(start, early, until).status(), Status::kInvalidArgument);
  const std::array<Burn, 1> late{burn(2001)};
  EXPECT_EQ(fly(start, late, until).status(), Status::kInvalidArgument);
  EXPECT_EQ(fly(start, {}, GpsTime{}).status(), Status::kInvalidArgument);
}

TEST(RemainingProblem, IsWhatTheFreeDriftAfterCommittedBurnsLeaves) {
  const MeanOrbits start = waypoint_zero({});
  const std::array<Burn, 1> committed{Burn{GpsTime{} + duration_of_seconds(100), Vector3(0.0, -0.2, 0.1)}};
  const GpsTime earliest = GpsTime{} + duration_of_seconds(300);
  const Waypoint waypoint{GpsTime{} + duration_of_seconds(21600), mission::kWaypoints[1].roe()};
  const Result<ControlProblem> problem = remaining_problem(start, committed, earliest, waypoint);
  const Result<Vector6> error = arrival_error(start, committed, waypoint);
  ASSERT_TRUE(problem.ok() && error.ok());
  EXPECT_LT((problem.value().pseudo_state - error.value()).norm(), 1e-12);  // the same but for rounding
  EXPECT_EQ(problem.value().start, earliest);
  EXPECT_EQ(problem.value().arrival, waypoint.time);
  EXPECT_EQ(remaining_problem(start, {}, waypoint.time, waypoint).status(), Status::kInvalidArgument);
}

TEST(ArrivalError, CountsABurnAtTheWaypointsTime) {
  const MeanOrbits start = waypoint_zero({});
  const Waypoint waypoint{GpsTime{} + duration_of_seconds(21600), mission::kWaypoints[1].roe()};
  const std::array<Burn, 1> last{Burn{waypoint.time, Vector3(0.0, 1.0, 0.0)}};
  const Result<Vector6> with = arrival_error(start, last, waypoint);
  const Result<Vector6> without = arrival_error(start, {}, waypoint);
  ASSERT_TRUE(with.ok() && without.ok());
  // 2/n m of da per m/s; the servicer's burn lowers the target's, so the error grows.
  EXPECT_NEAR(mission::kReferenceA * (with.value()[0] - without.value()[0]), 1886.0, 10.0);
}

}  // namespace

}  // namespace vbar::fsw::control
