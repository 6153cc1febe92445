#include "host_sim/campaign_report/percentile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace vbar::campaign_report::test {
namespace {

constexpr double kConfidence = 0.95;

void expect_ranks(std::size_t count, double share, std::optional<std::size_t> lower, std::optional<std::size_t> upper) {
  const PercentileRanks ranks = percentile_ranks(count, share, kConfidence);
  EXPECT_EQ(ranks.lower, lower) << share << " of " << count;
  EXPECT_EQ(ranks.upper, upper) << share << " of " << count;
}

// Intervals of the median as tables of the sign test print them. Of the 95th percentile: P(X <= k) of X ~ B(100, 0.95)
// is 0.0115, 0.0282, 0.9629 and 0.9941 for k = 89, 90, 98 and 99.
TEST(Percentile, RanksAreThoseOfPublishedTables) {
  expect_ranks(6, 0.5, 1, 6);
  expect_ranks(10, 0.5, 2, 9);
  expect_ranks(20, 0.5, 6, 15);
  expect_ranks(25, 0.5, 8, 18);
  expect_ranks(100, 0.95, 90, 100);
}

TEST(Percentile, BoundsThatTheValuesDoNotSupportAreOpen) {
  expect_ranks(0, 0.5, std::nullopt, std::nullopt);
  expect_ranks(5, 0.5, std::nullopt, std::nullopt);
  expect_ranks(20, 0.95, 17, std::nullopt);
  EXPECT_FALSE(percentile_ranks(1000, 0.997, kConfidence).upper);
  for (const double share : {0.5, 0.9, 0.95, 0.99, 0.997}) {
    const std::size_t needed = values_needed(share, kConfidence);
    EXPECT_TRUE(percentile_ranks(needed, share, kConfidence).upper) << share;
    EXPECT_FALSE(percentile_ranks(needed - 1, share, kConfidence).upper) << share;
  }
  EXPECT_EQ(values_needed(0.95, kConfidence), 72U) << "0.95^72 = 0.0249";

  const std::vector<double> twenty(20, 1.0);
  const Percentile found = percentile(twenty, 0.95, kConfidence);
  EXPECT_FALSE(found.estimate) << "not stated";
  EXPECT_FALSE(found.upper);
  EXPECT_EQ(found.lower, 1.0);
}

/// P(from <= X <= to) of X ~ B(count, share), by summation.
double binomial_probability(std::size_t count, double share, std::size_t from, std::size_t to) {
  double sum = 0.0;
  const auto n = static_cast<double>(count);
  for (std::size_t successes = from; successes <= to; ++successes) {
    const auto k = static_cast<double>(successes);
    sum += std::exp(std::lgamma(n + 1.0) - std::lgamma(k + 1.0) - std::lgamma(n - k + 1.0) + k * std::log(share) +
                    (n - k) * std::log1p(-share));
  }
  return sum;
}

/// Of the true quantile by the interval: at least `lower` and fewer than `upper` values lie below it.
double exact_coverage(std::size_t count, double share, const PercentileRanks& ranks) {
  return binomial_probability(count, share, ranks.lower.value_or(0), ranks.upper ? *ranks.upper - 1 : count);
}

// The interval covers at least as stated, and is the narrowest of its kind: one rank less on either side leaves too
// much.
TEST(Percentile, CoversTheQuantileAtLeastAsStated) {
  for (const double share : {0.05, 0.5, 0.9, 0.95, 0.99, 0.997}) {
    for (const std::size_t count : {1U, 3U, 10U, 37U, 100U, 400U, 1500U}) {
      const PercentileRanks ranks = percentile_ranks(count, share, kConfidence);
      EXPECT_GE(exact_coverage(count, share, ranks), kConfidence) << share << " of " << count;
      if (ranks.lower) {
        EXPECT_LE(binomial_probability(count, share, 0, *ranks.lower - 1), 0.025);
        EXPECT_GT(binomial_probability(count, share, 0, *ranks.lower), 0.025);
      }
      if (ranks.upper) {
        EXPECT_LE(binomial_probability(count, share, *ranks.upper, count), 0.025);
        EXPECT_GT(binomial_probability(count, share, *ranks.upper - 1, count), 0.025);
      }
    }
  }
}

// 2,000 campaigns of 100 cases with exponentially distributed figures, whose p quantile is -log(1 - p).
TEST(Percentile, CoversInSyntheticCampaigns) {
  constexpr int kCampaigns = 2000;
  constexpr std::size_t kCases = 100;
  constexpr std::array kShares{0.5, 0.9, 0.95, 0.99};
  std::array<int, kShares.size()> covered{};
  std::mt19937_64 engine(1);
  std::exponential_distribution<double> distribution;
  for (int campaign = 0; campaign < kCampaigns; ++campaign) {
    std::vector<double> values(kCases);
    for (double& value : values) value = distribution(engine);
    std::ranges::sort(values);
    for (std::size_t k = 0; k < kShares.size(); ++k) {
      const Percentile found = percentile(values, kShares[k], kConfidence);
      const double truth = -std::log1p(-kShares[k]);
      const bool is_inside = (!found.lower || *found.lower <= truth) && (!found.upper || truth <= *found.upper);
      covered[k] += is_inside ? 1 : 0;
    }
  }
  for (std::size_t k = 0; k < kShares.size(); ++k) {
    const double exact = exact_coverage(kCases, kShares[k], percentile_ranks(kCases, kShares[k], kConfidence));
    const double sigma = std::sqrt(exact * (1.0 - exact) / kCampaigns);
    EXPECT_NEAR(static_cast<double>(covered[k]) / kCampaigns, exact, 4.0 * sigma) << kShares[k];
    EXPECT_GE(static_cast<double>(covered[k]) / kCampaigns, kConfidence) << kShares[k];
  }
}

}  // namespace
}  // namespace vbar::campaign_report::test
