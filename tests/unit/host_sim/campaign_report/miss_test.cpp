#include "host_sim/campaign_report/miss.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace vbar::campaign_report::test {
namespace {

constexpr double kConfidence = 0.95;
constexpr Plane kPlane{"RN", 0, 2};

// Of a circular Gaussian without bias: CEP is 1.1774 sigma, R95 2.4477 sigma (Rayleigh distribution).
TEST(Miss, RadiiOfACircularGaussian) {
  std::mt19937_64 engine(1);
  std::normal_distribution<double> normal(0.0, 3.0);
  VectorError error;
  for (int k = 0; k < 4000; ++k) error.errors_rtn_m.push_back({normal(engine), 1e3, normal(engine)});
  const PlaneMiss miss = miss_in(kPlane, error, kConfidence);
  ASSERT_TRUE(miss.cep_m.estimate && miss.r95_m.estimate && miss.cep_m.lower && miss.r95_m.upper);
  // Standard errors of the two quantiles of 4000 values: 1.3 and 1.5 % of themselves; four of them.
  EXPECT_NEAR(*miss.cep_m.estimate, 1.1774 * 3.0, 0.2);
  EXPECT_NEAR(*miss.r95_m.estimate, 2.4477 * 3.0, 0.44);
  EXPECT_LT(*miss.cep_m.lower, *miss.cep_m.estimate);
  EXPECT_GT(*miss.r95_m.upper, *miss.r95_m.estimate);
  EXPECT_NEAR(miss.sigma_m[0], 3.0, 0.2);
  EXPECT_NEAR(miss.sigma_m[1], 3.0, 0.2);
}

// Four cases on an ellipse about (10, 20), with semi-axes along (3, 4) / 5 and across it: covariance by hand.
TEST(Miss, EllipseOfTheSampleCovariance) {
  VectorError error;
  for (const auto& [along, across] : {std::pair{5.0, 0.0}, {-5.0, 0.0}, {0.0, 2.0}, {0.0, -2.0}})
    error.errors_rtn_m.push_back({10.0 + 0.6 * along - 0.8 * across, 0.0, 20.0 + 0.8 * along + 0.6 * across});
  const PlaneMiss miss = miss_in(kPlane, error, kConfidence);
  EXPECT_NEAR(miss.mean_m[0], 10.0, 1e-14);
  EXPECT_NEAR(miss.mean_m[1], 20.0, 1e-14);
  EXPECT_NEAR(miss.sigma_m[0], std::sqrt(50.0 / 3.0), 1e-13);
  EXPECT_NEAR(miss.sigma_m[1], std::sqrt(8.0 / 3.0), 1e-13);
  EXPECT_NEAR(miss.angle_rad, std::atan2(0.8, 0.6), 1e-14);
  EXPECT_FALSE(miss.r95_m.upper) << "four cases do not bound it";
  EXPECT_FALSE(miss.cep_m.estimate);
}

TEST(Miss, IsFoundByItsThreeComponents) {
  Campaign campaign;
  campaign.cases.resize(4);
  for (Case& one : campaign.cases) one.state = State::kComplete;
  campaign.cases[1].state = State::kFailed;
  campaign.figures = {{"waypoints.9.control_error_r_m", {1, 2, 3, 4}},
                      {"waypoints.9.control_error_t_m", {1, 2, 3, std::nan("")}},
                      {"waypoints.9.control_error_n_m", {5, 6, 7, 8}},
                      {"samples.1h.sigma_r_m", {1, 1, 1, 1}},
                      {"waypoints.10.control_error_r_m", {1, 2, 3, 4}}};
  const std::vector<VectorError> found = vector_errors(campaign);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].key, "waypoints.9.control_error");
  ASSERT_EQ(found[0].errors_rtn_m.size(), 2U) << "neither failed cases nor those without a component";
  EXPECT_EQ(found[0].errors_rtn_m[1][2], 7.0);
}

}  // namespace
}  // namespace vbar::campaign_report::test
