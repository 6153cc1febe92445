#include "host_sim/report/navigation_errors.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

namespace vbar::report::test {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

constexpr double kRadius_m = 7.0e6;
constexpr double kRate_radps = 1.0780007612e-3;  // sqrt(mu / r^3), mu = 3.986004418e14 m^3/s^2

/// A circular orbit at its node.
TruthRow truth_at(double time_s, const Vector6& relative) {
  TruthRow row;
  row.time_s = time_s;
  row.servicer_position_eci = {kRadius_m, 0.0, 0.0};
  row.servicer_velocity_eci = {0.0, kRadius_m * kRate_radps, 0.0};
  row.relative_position_rtn = {relative(0), relative(1), relative(2)};
  row.relative_velocity_rtn = {relative(3), relative(4), relative(5)};
  return row;
}

EstimateRow estimate_at(double time_s, const Vector6& relative, int source) {
  EstimateRow row;
  row.time_s = time_s;
  row.navigation_valid = 1;
  row.navigation_source = source;
  row.relative_position_rtn = {relative(0), relative(1), relative(2)};
  row.relative_velocity_rtn = {relative(3), relative(4), relative(5)};
  return row;
}

GnssRow gnss_at(double time_s, double epoch_s, const Matrix6& covariance) {
  GnssRow row;
  row.time_s = time_s;
  row.epoch_s = epoch_s;
  std::size_t place = 0;
  for (int r = 0; r < 6; ++r)
    for (int c = 0; c <= r; ++c) row.covariance_rtn[place++] = covariance(r, c);
  return row;
}

/// Hill's equations in a step of Runge-Kutta 4 a tenth of a second: independent of their closed solution.
Vector6 flown(Vector6 state, double seconds) {
  const auto rate = [](const Vector6& s) {
    constexpr double n = kRate_radps;
    Vector6 d;
    d << s(3), s(4), s(5), 3.0 * n * n * s(0) + 2.0 * n * s(4), -2.0 * n * s(3), -n * n * s(2);
    return d;
  };
  constexpr double h = 0.1;
  for (int k = 0; k < static_cast<int>(std::lround(seconds / h)); ++k) {
    const Vector6 k1 = rate(state);
    const Vector6 k2 = rate(state + 0.5 * h * k1);
    const Vector6 k3 = rate(state + 0.5 * h * k2);
    const Vector6 k4 = rate(state + h * k3);
    state += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  }
  return state;
}

Matrix6 some_covariance() {
  Matrix6 root;
  root << 4e-3, 0, 0, 0, 0, 0,        //
      1e-3, 5e-3, 0, 0, 0, 0,         //
      -2e-3, 1e-3, 3e-3, 0, 0, 0,     //
      1e-6, 0, 2e-6, 4e-6, 0, 0,      //
      -5e-6, 1e-6, 0, 1e-6, 3e-6, 0,  //
      0, 2e-6, 1e-6, 0, 1e-6, 5e-6;
  return root * root.transpose();
}

// An error drawn from the covariance at the epoch and flown on to the step has the NEES it had: the flow is one to one
// and linear.
TEST(NavigationErrors, NeesIsTheOneOfTheEpoch) {
  const Matrix6 covariance = some_covariance();
  std::mt19937 generator(3);
  std::normal_distribution<double> normal;
  const Matrix6 root = covariance.llt().matrixL();
  for (const double age_s : {0.0, 10.0, 30.0}) {
    Vector6 white;
    for (int k = 0; k < 6; ++k) white(k) = normal(generator);
    Vector6 relative;
    relative << 1.0, -8.0, 0.5, 1e-3, -2e-3, 1e-3;
    RunRecord record;
    record.truth.push_back(truth_at(100.0, relative));
    record.estimates.push_back(estimate_at(100.0, relative + flown(root * white, age_s), 4));
    record.gnss.push_back(gnss_at(100.0, 100.0 - age_s, covariance));
    const std::vector<NavigationError> errors = navigation_errors(record);
    ASSERT_EQ(errors.size(), 1U);
    ASSERT_TRUE(errors[0].nees.has_value());
    // Runge-Kutta 4 errs by (n h)^5 a step, far below 1e-12; adding 8 m to an error of 5 mm leaves 2e-13 of it, which
    // the covariance's condition number of 1e8 may enlarge in the smallest direction: to 1e-8 at most.
    EXPECT_NEAR(*errors[0].nees, white.squaredNorm(), 1e-7) << age_s;
  }
}

TEST(NavigationErrors, AreEstimateLessTruthOfValidSteps) {
  RunRecord record;
  Vector6 truth = Vector6::Zero();
  truth(1) = -7.0;
  Vector6 estimate = truth;
  estimate(0) = 0.25;
  estimate(5) = -0.5;
  for (const double t : {0.0, 10.0, 20.0}) {
    record.truth.push_back(truth_at(t, truth));
    record.estimates.push_back(estimate_at(t, estimate, 4));
  }
  record.estimates[1].navigation_valid = 0;
  record.estimates.push_back(estimate_at(25.0, estimate, 4));  // no truth of that time
  const std::vector<NavigationError> errors = navigation_errors(record);
  ASSERT_EQ(errors.size(), 2U);
  EXPECT_EQ(errors[1].time_s, 20.0);
  EXPECT_EQ(errors[1].position_rtn, (Triple{0.25, 0.0, 0.0}));
  EXPECT_EQ(errors[1].velocity_rtn, (Triple{0.0, 0.0, -0.5}));
}

TEST(NavigationErrors, NeesIsOfFreshGnssWithACovarianceOnly) {
  const Vector6 zero = Vector6::Zero();
  const auto nees_of = [&](int source, const std::function<void(RunRecord&)>& change) {
    RunRecord record;
    record.truth.push_back(truth_at(10.0, zero));
    record.estimates.push_back(estimate_at(10.0, zero, source));
    record.gnss.push_back(gnss_at(10.0, 0.0, some_covariance()));
    change(record);
    return navigation_errors(record).at(0).nees;
  };
  const auto nothing = [](RunRecord&) {};
  EXPECT_TRUE(nees_of(3, nothing).has_value()) << "float";
  EXPECT_TRUE(nees_of(4, nothing).has_value()) << "fixed";
  EXPECT_FALSE(nees_of(1, nothing).has_value()) << "coasting";
  EXPECT_FALSE(nees_of(2, nothing).has_value()) << "ideal";
  EXPECT_FALSE(nees_of(4, [](RunRecord& r) { r.gnss.clear(); }).has_value());
  EXPECT_FALSE(nees_of(4, [](RunRecord& r) { r.gnss[0].epoch_s.reset(); }).has_value());
  EXPECT_FALSE(nees_of(4, [](RunRecord& r) { std::ranges::fill(r.gnss[0].covariance_rtn, 0.0); }).has_value())
      << "singular";
}

TEST(NavigationErrors, FirstFixIsTheFirstStepByFixedAmbiguities) {
  RunRecord record;
  EXPECT_FALSE(first_fix(record).has_value());
  const Vector6 zero = Vector6::Zero();
  record.estimates = {estimate_at(0.0, zero, 3), estimate_at(10.0, zero, 4), estimate_at(20.0, zero, 4)};
  EXPECT_EQ(first_fix(record), 10.0);
  record.estimates[1].navigation_valid = 0;
  EXPECT_EQ(first_fix(record), 20.0);
}

}  // namespace
}  // namespace vbar::report::test
