// Consistency of navigation by GNSS: its covariance against the truth.

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "host_sim/sensors/gnss/gnss_rows.h"
#include "tests/unit/host_sim/report/synthetic_run.h"

namespace vbar::sensors::test {
namespace {

using report::RunRecord;
using report::test::estimate_at;
using report::test::kRate_radps;
using report::test::truth_at;
using report::test::Vector6;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

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
TEST(GnssNees, IsTheOneOfTheEpoch) {
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
    record.tables.rows<GnssRow>().push_back(gnss_at(100.0, 100.0 - age_s, covariance));
    const std::map<double, double> nees = gnss_nees(record);
    ASSERT_EQ(nees.size(), 1U);
    // Runge-Kutta 4 errs by (n h)^5 a step, far below 1e-12; adding 8 m to an error of 5 mm leaves 2e-13 of it, which
    // the covariance's condition number of 1e8 may enlarge in the smallest direction: to 1e-8 at most.
    EXPECT_NEAR(nees.at(100.0), white.squaredNorm(), 1e-7) << age_s;
  }
}

TEST(GnssNees, IsOfFreshGnssWithACovarianceOnly) {
  const Vector6 zero = Vector6::Zero();
  const auto nees_of = [&](int source, const std::function<void(RunRecord&)>& change) {
    RunRecord record;
    record.truth.push_back(truth_at(10.0, zero));
    record.estimates.push_back(estimate_at(10.0, zero, source));
    record.tables.rows<GnssRow>().push_back(gnss_at(10.0, 0.0, some_covariance()));
    change(record);
    return gnss_nees(record);
  };
  const auto nothing = [](RunRecord&) {};
  EXPECT_FALSE(nees_of(3, nothing).empty()) << "float";
  EXPECT_FALSE(nees_of(4, nothing).empty()) << "fixed";
  EXPECT_TRUE(nees_of(1, nothing).empty()) << "coasting";
  EXPECT_TRUE(nees_of(2, nothing).empty()) << "ideal";
  EXPECT_TRUE(nees_of(4, [](RunRecord& r) { r.tables.rows<GnssRow>().clear(); }).empty());
  EXPECT_TRUE(nees_of(4, [](RunRecord& r) { r.tables.rows<GnssRow>()[0].epoch_s.reset(); }).empty());
  EXPECT_TRUE(
      nees_of(4, [](RunRecord& r) { std::ranges::fill(r.tables.rows<GnssRow>()[0].covariance_rtn, 0.0); }).empty())
      << "singular";
}

}  // namespace
}  // namespace vbar::sensors::test
