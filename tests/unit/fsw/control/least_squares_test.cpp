// Time-fixed least squares on the close legs of the mission. Expected numbers: an independent implementation (numpy), W
// = I in metres.

#include "fsw/control/least_squares.h"

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "fsw/control/correction.h"
#include "fsw/control/leg.h"
#include "fsw/orbit/roe.h"
#include "tests/support/allocation_counter.h"
#include "tests/unit/fsw/control/legs.h"
#include "tests/unit/fsw/control/mission_legs.h"

namespace vbar::fsw::control {

namespace {

// The oracle's burns and sums are given to 0.01 um/s; its finite differences are good to 1e-7 of some mm/s.
constexpr double kTolerance = 1e-8;

void expect_deputy_burn(const Burn& burn, double r_mmps, double t_mmps, double n_mmps) {
  EXPECT_NEAR(-burn.dv_rtn.x() * 1e3, r_mmps, kTolerance * 1e3);
  EXPECT_NEAR(-burn.dv_rtn.y() * 1e3, t_mmps, kTolerance * 1e3);
  EXPECT_NEAR(-burn.dv_rtn.z() * 1e3, n_mmps, kTolerance * 1e3);
}

TEST(LeastSquares, TwoBurnsOfLeg8To9) {
  const LeastSquaresSettings settings{.burn_count = 2, .regularisation = 0.0};
  LeastSquaresReport report;
  const auto plan = solve_least_squares(leg_8_to_9(), settings, &report);
  ASSERT_TRUE(plan.ok());
  ASSERT_EQ(plan.value().count, 2U);
  expect_deputy_burn(plan.value().burns[0], -2.08990, 0.40444, -3.19114);
  expect_deputy_burn(plan.value().burns[1], -0.30111, -0.14082, -3.78226);
  EXPECT_NEAR(plan.value().total_dv(), 7.63281e-3, kTolerance);
  EXPECT_NEAR(report.largest_singular_value / report.smallest_singular_value, 25.7860, 1e-4);  // digits given
  EXPECT_LT(report.residual_m, 1e-11);                                                         // rounding of metres
}

TEST(LeastSquares, ThreeBurnsOfLeg8To9AreTheMinimumNormSolution) {
  const LeastSquaresSettings settings{.regularisation = 0.0};
  const auto plan = solve_least_squares(leg_8_to_9(), settings);
  ASSERT_TRUE(plan.ok());
  ASSERT_EQ(plan.value().count, 3U);
  expect_deputy_burn(plan.value().burns[0], -1.32826, 0.05452, -0.33383);
  expect_deputy_burn(plan.value().burns[1], 0.45886, 0.48460, 1.89412);
  expect_deputy_burn(plan.value().burns[2], -0.90679, -0.27481, -0.92066);
  EXPECT_NEAR(plan.value().total_dv(), 4.70005e-3, kTolerance);
  EXPECT_EQ(plan.value().solver, LeastSquares::kId);
}

TEST(LeastSquares, RegularisationTradesArrivalForFuel) {
  LeastSquaresReport report;
  const auto plan = solve_least_squares(leg_8_to_9(), {.regularisation = 1e4}, &report);
  ASSERT_TRUE(plan.ok());
  EXPECT_NEAR(plan.value().total_dv(), 4.65602e-3, kTolerance);
  EXPECT_NEAR(report.residual_m, 2.6537e-2, 1e-6);  // digits given
}

// A backup that is to arrive within centimetres may lose less than one to its default regularisation.
TEST(LeastSquares, DefaultRegularisationCostsUnderAMillimetre) {
  LeastSquaresReport report;
  ASSERT_TRUE(solve_least_squares(leg_8_to_9(), {}, &report).ok());
  EXPECT_LT(report.residual_m, 1e-3);
  EXPECT_GT(report.residual_m, 0.0);
}

TEST(LeastSquares, BurnsOfLeg9To10) {
  LeastSquaresSettings settings{.burn_count = 2, .regularisation = 0.0};
  EXPECT_NEAR(solve_least_squares(leg_9_to_10(), settings).value().total_dv(), 1.29075e-3, kTolerance);
  settings.burn_count = 3;
  EXPECT_NEAR(solve_least_squares(leg_9_to_10(), settings).value().total_dv(), 1.57743e-3, kTolerance);
}

// Half an orbit apart, two normal burns move the orbit plane about one axis only.
TEST(LeastSquares, HalfAnOrbitBetweenTwoBurnsIsSingular) {
  ControlProblem problem = leg_8_to_9();
  const auto rates = orbit::secular_rates(problem.servicer_mean);
  const double half_orbit = 3.14159265358979323846 / rates.mean_argument_of_latitude();
  problem.arrival = problem.start + nearest_duration(half_orbit);
  LeastSquaresReport report;
  const auto two = solve_least_squares(problem, {.burn_count = 2, .regularisation = 0.0}, &report);
  // The normal burn's phase is that of the true latitude, 0.1 deg from the mean one, so the singularity is not hit
  // exactly: two burns are accepted, but a mm/s of theirs moves the orbit plane by less than 10 mm (a m/s of one burn:
  // 942 m).
  EXPECT_EQ(two.status(), Status::kOk);
  EXPECT_LT(report.smallest_singular_value, 10.0);

  const auto three = solve_least_squares(problem, {.regularisation = 0.0}, &report);
  ASSERT_TRUE(three.ok());
  EXPECT_LT(report.largest_singular_value / report.smallest_singular_value, 1e2);
}

// With the ends whole orbits apart and a burn in the very middle, all three normal burns would act alike: the middle
// moves.
TEST(LeastSquares, MiddleBurnAvoidsASingularSpacing) {
  ControlProblem problem = leg_8_to_9();
  const double orbit =
      2.0 * 3.14159265358979323846 / orbit::secular_rates(problem.servicer_mean).mean_argument_of_latitude();
  problem.arrival = problem.start + nearest_duration(orbit);
  LeastSquaresReport report;
  ASSERT_TRUE(solve_least_squares(problem, {}, &report).ok());
  EXPECT_NE(report.middle, problem.start + nearest_duration(orbit / 2.0));
  EXPECT_LT(report.largest_singular_value / report.smallest_singular_value, 1e2);
}

// A large weight on dlambda buys its accuracy from the other elements.
TEST(LeastSquares, WeightDecidesWhoGivesWay) {
  LeastSquaresSettings settings{.regularisation = 1e6};
  LeastSquaresReport even, weighted;
  const auto plain = solve_least_squares(leg_8_to_9(), settings, &even);
  settings.weight(1) = 100.0;
  const auto favoured = solve_least_squares(leg_8_to_9(), settings, &weighted);
  ASSERT_TRUE(plain.ok() && favoured.ok());
  EXPECT_GT(even.residual_m, 0.1);
  EXPECT_NE(even.residual_m, weighted.residual_m);
}

TEST(LeastSquares, BadInputIsRefused) {
  ControlProblem problem = leg_8_to_9();
  EXPECT_EQ(solve_least_squares(problem, {.burn_count = 4}).status(), Status::kInvalidArgument);
  EXPECT_EQ(solve_least_squares(problem, {.regularisation = -1.0}).status(), Status::kInvalidArgument);
  EXPECT_EQ(solve_least_squares(problem, {.weight = Vector6::Zero()}).status(), Status::kInvalidArgument);
  problem.pseudo_state(2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(solve_least_squares(problem).status(), Status::kNotFinite);
  problem = leg_8_to_9();
  problem.arrival = problem.start;
  EXPECT_EQ(solve_least_squares(problem).status(), Status::kSingular);
  problem.arrival = problem.start - Duration{1};
  EXPECT_EQ(solve_least_squares(problem).status(), Status::kOutOfRange);
}

TEST(LeastSquares, SolvesWithoutTheHeap) {
  const ControlProblem problem = leg_8_to_9();
  const std::size_t before = test::allocation_count();
  const auto plan = solve_least_squares(problem);
  const std::size_t after = test::allocation_count();
  ASSERT_TRUE(plan.ok());
  EXPECT_EQ(after, before);
}

}  // namespace

// Least-norm corrections: against a singular value decomposition, and on plans that were spoilt.

namespace {

namespace mission = orbit::mission;

// On arrival at 20000 s; s.
Matrix63 effect_of_burn_at(double time) {
  return arrival_effect(mission::kServicerMean, {}, GpsTime{} + nearest_duration(time),
                        GpsTime{} + nearest_duration(2e4));
}

std::vector<Matrix63> random_effects(std::mt19937& random, std::size_t count) {
  std::uniform_real_distribution<double> time(0.0, 20000.0);
  std::vector<Matrix63> effects;
  for (std::size_t k = 0; k < count; ++k) effects.push_back(effect_of_burn_at(time(random)));
  return effects;
}

TEST(LeastNormCorrection, IsThePseudoInverseOfTheWeightedEffects) {
  std::mt19937 random(3);
  std::normal_distribution<double> standard;
  const CorrectionSettings settings{.radial_price = 3.0, .min_gain = 1e-4};
  for (int trial = 0; trial < 20; ++trial) {
    const std::vector<Matrix63> effects = random_effects(random, 2 + static_cast<std::size_t>(trial) % 5);
    const Vector6 residual = 1e-6 * Vector6::NullaryExpr([&] { return standard(random); });
    const Result<Correction> correction = least_norm_correction(effects, residual, settings);
    ASSERT_TRUE(correction.ok());

    // Minimise sum (3 dv_R)^2 + dv_T^2 + dv_N^2 subject to the residual: x = W^-1 (A W^-1)^+ r.
    const auto columns = static_cast<Eigen::Index>(3 * effects.size());
    Eigen::MatrixXd weighted(6, columns);
    for (std::size_t k = 0; k < effects.size(); ++k) {
      weighted.block<6, 3>(0, static_cast<Eigen::Index>(3 * k)) =
          effects[k] * Vector3(1.0 / 3.0, 1.0, 1.0).asDiagonal();
    }
    const Eigen::VectorXd y = weighted.completeOrthogonalDecomposition().solve(residual);
    Vector6 reached = Vector6::Zero();
    for (std::size_t k = 0; k < effects.size(); ++k) {
      const Vector3 expected =
          Vector3(1.0 / 3.0, 1.0, 1.0).cwiseProduct(y.segment<3>(static_cast<Eigen::Index>(3 * k)));
      // Forming A A' squares the condition of up to 1e4.
      EXPECT_LT((correction.value().dv[k] - expected).norm(), 1e-6 * y.norm()) << trial;
      reached += effects[k] * correction.value().dv[k];
    }
    EXPECT_LT((reached - residual).norm(), 1e-6 * residual.norm()) << trial;
  }
}

TEST(LeastNormCorrection, LeavesDirectionsOfLittleGainAlone) {
  // One burn cannot move the inclination vector across its own phase: asked for just that, it does next to nothing.
  const std::vector<Matrix63> effects = {effect_of_burn_at(5000.0)};
  Vector6 residual = Vector6::Zero();
  residual[4] = -effects[0](5, 2);
  residual[5] = effects[0](4, 2);
  const Result<Correction> correction = least_norm_correction(effects, residual);
  ASSERT_TRUE(correction.ok());
  EXPECT_LT(correction.value().dv[0].norm(), 0.02);  // of the 1 m/s to which the residual is scaled
}

TEST(LeastNormCorrection, RefusesNonsense) {
  const std::vector<Matrix63> none;
  EXPECT_EQ(least_norm_correction(none, Vector6::Ones()).status(), Status::kInvalidArgument);
  const std::vector<Matrix63> many(kMaxBurns + 1, Matrix63::Ones());
  EXPECT_EQ(least_norm_correction(many, Vector6::Ones()).status(), Status::kInvalidArgument);
  const std::vector<Matrix63> zero(2, Matrix63::Zero());
  EXPECT_EQ(least_norm_correction(zero, Vector6::Ones()).status(), Status::kSingular);
  std::vector<Matrix63> bad(2, Matrix63::Ones());
  EXPECT_EQ(least_norm_correction(bad, Vector6::Constant(std::nan(""))).status(), Status::kNotFinite);
  bad[1](2, 2) = std::nan("");
  EXPECT_EQ(least_norm_correction(bad, Vector6::Ones()).status(), Status::kNotFinite);
}

class CorrectPlan : public ::testing::Test {
 protected:
  void SetUp() override {
    const mission::Waypoint& from = mission::kWaypoints[1];
    const orbit::QnsElements servicer = orbit::propagate_secular(mission::kServicerMean, from.time_h * 3600.0);
    situation_.orbits = {{}, servicer, orbit::qns_from_roe(servicer, from.roe())};
    situation_.earliest_burn = GpsTime{} + duration_of_seconds(10);
    situation_.waypoint = {GpsTime{} + duration_of_seconds(21600), mission::kWaypoints[2].roe()};
    const Result<Plan> plan = plan_closed_form(situation_, {});
    ASSERT_TRUE(plan.ok());
    plan_ = plan.value();
  }

  double error_m(const Plan& plan) const {
    return mission::kReferenceA * evaluate_plan(situation_, plan).value().norm();
  }

  LegSituation situation_;
  Plan plan_;
};

TEST_F(CorrectPlan, RestoresAPlanWhoseBurnsWereSpoilt) {
  Plan spoilt = plan_;
  for (std::size_t k = 0; k < spoilt.count; ++k) spoilt.burns[k].dv_rtn *= 1.0 + 0.02 * (k % 2 == 0 ? 1.0 : -1.0);
  ASSERT_GT(error_m(spoilt), 100.0);
  const Result<Plan> corrected = correct_plan(situation_.orbits, {}, spoilt, situation_.waypoint);
  ASSERT_TRUE(corrected.ok());
  EXPECT_LT(error_m(corrected.value()), 0.05);  // three Newton steps, each to about 1e-2, from hundreds of metres
  EXPECT_LT(std::abs(corrected.value().total_dv() - plan_.total_dv()), 0.01 * plan_.total_dv());
  for (std::size_t k = 0; k < plan_.count; ++k) EXPECT_EQ(corrected.value().burns[k].time, plan_.burns[k].time);
}

TEST_F(CorrectPlan, TakesCommittedBurnsAsGiven) {
  Plan committed;
  committed.burns[committed.count++] = plan_.burns[0];
  Plan rest;
  for (std::size_t k = 1; k < plan_.count; ++k) rest.burns[rest.count++] = plan_.burns[k];
  Plan spoilt = rest;
  for (std::size_t k = 0; k < spoilt.count; ++k) spoilt.burns[k].dv_rtn *= 1.01;
  const Result<Plan> corrected = correct_plan(situation_.orbits, committed, spoilt, situation_.waypoint);
  ASSERT_TRUE(corrected.ok());
  // With the first burn ignored, the others would have to change by its size, 0.36 m/s.
  for (std::size_t k = 0; k < rest.count; ++k) {
    EXPECT_LT((corrected.value().burns[k].dv_rtn - rest.burns[k].dv_rtn).norm(), 0.01);
  }
  situation_.committed = committed;
  situation_.earliest_burn = rest.burns[0].time;
  EXPECT_LT(error_m(corrected.value()), 0.2 * error_m(spoilt));
}

TEST_F(CorrectPlan, NeedsABurn) {
  EXPECT_EQ(correct_plan(situation_.orbits, {}, Plan{}, situation_.waypoint).status(), Status::kInvalidArgument);
}

TEST(ArrivalDistance, IsTheNormOfTheRelativePosition) {
  MeanOrbits orbits;
  orbits.servicer = mission::kServicerMean;
  const Waypoint waypoint{GpsTime{} + duration_of_seconds(5000), Vector6::Zero()};
  Vector6 error = Vector6::Zero();
  error[0] = 3.0 / mission::kReferenceA;
  error[1] = 4.0 / mission::kReferenceA;
  const Result<double> distance = arrival_distance(orbits, waypoint, error);
  ASSERT_TRUE(distance.ok());
  EXPECT_NEAR(distance.value(), 5.0, 1e-9);
}

}  // namespace

}  // namespace vbar::fsw::control
