// Time-fixed least squares on the close legs of the mission. Expected numbers: an independent implementation (numpy), W
// = I in metres.

#include "fsw/control/least_squares.h"

#include <limits>

#include <gtest/gtest.h>

#include "tests/support/allocation_counter.h"
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
}  // namespace vbar::fsw::control
