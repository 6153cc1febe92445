#include "host_sim/campaign_report/statistics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace vbar::campaign_report::test {

namespace {

constexpr double kStates = 6.0;

std::vector<NormalisedError> equal_errors(std::size_t cases, double value, double dimension) {
  return std::vector<NormalisedError>(cases, {value, dimension});
}

// Quantiles of chi-square with 6 n degrees of freedom, as tables print them, by n; of 60: 40.482 and 83.298.
TEST(EnsembleConsistency, BandsAreThoseOfChiSquareTables) {
  const auto expect_band = [](std::size_t cases, double low, double high) {
    const Epoch epoch = epoch_of(1.0, equal_errors(cases, kStates, kStates));
    EXPECT_NEAR(epoch.band.low, low, 0.005) << cases;
    EXPECT_NEAR(epoch.band.high, high, 0.005) << cases;
    EXPECT_EQ(epoch.cases, cases);
  };
  expect_band(10, 4.05, 8.33);
  expect_band(20, 4.58, 7.61);
  expect_band(100, 5.34, 6.70);
  expect_band(1000, 5.79, 6.22);
}

// The mean at an edge of the 95 % band has a two-sided p value of 5 %.
TEST(EnsembleConsistency, PValueIsFivePerCentAtTheEdges) {
  const Epoch any = epoch_of(1.0, equal_errors(50, kStates, kStates));
  EXPECT_NEAR(epoch_of(1.0, equal_errors(50, any.band.low, kStates)).p_value, 0.05, 1e-9);
  EXPECT_NEAR(epoch_of(1.0, equal_errors(50, any.band.high, kStates)).p_value, 0.05, 1e-9);
}

TEST(EnsembleConsistency, CasesMayHaveDifferentDimensions) {
  const Epoch mixed = epoch_of(2.0, {{3.0, 2.0}, {5.0, 4.0}, {4.0, 6.0}});
  const Epoch same = epoch_of(2.0, equal_errors(3, 4.0, 4.0));
  EXPECT_EQ(mixed.mean, 4.0);
  EXPECT_EQ(mixed.mean_dimension, 4.0);
  EXPECT_EQ(mixed.band.low, same.band.low) << "the sum of the dimensions is the same";
}

/// Epochs of a filter whose claimed sigmas are `scale` times its errors'.
std::vector<Epoch> synthetic_epochs(std::size_t epochs, std::size_t cases, double scale, std::mt19937_64& engine) {
  std::chi_squared_distribution<double> nees(kStates);
  std::vector<Epoch> all;
  for (std::size_t k = 0; k < epochs; ++k) {
    std::vector<NormalisedError> errors;
    for (std::size_t n = 0; n < cases; ++n) errors.push_back({nees(engine) / (scale * scale), kStates});
    all.push_back(epoch_of(static_cast<double>(k), errors));
  }
  return all;
}

TEST(EnsembleConsistency, AConsistentFilterIsInsideItsBand) {
  std::mt19937_64 engine(1);
  const Consistency found = consistency_of(synthetic_epochs(1000, 100, 1.0, engine));
  EXPECT_GE(found.share_inside(), 0.90);
  EXPECT_LE(found.share_inside(), 0.98);
  EXPECT_FALSE(found.is_rejected) << found.p_value;
  EXPECT_EQ(found.epochs, 1000U);
}

// Whether it is rejected is decided at 5 %, for any number of epochs.
TEST(EnsembleConsistency, AConsistentFilterIsSeldomRejected) {
  constexpr int kCampaigns = 400;
  std::mt19937_64 engine(2);
  int rejected = 0;
  for (int k = 0; k < kCampaigns; ++k)
    rejected += consistency_of(synthetic_epochs(20, 20, 1.0, engine)).is_rejected ? 1 : 0;
  EXPECT_LE(rejected, 0.05 * kCampaigns + 4.0 * std::sqrt(0.05 * 0.95 * kCampaigns)) << "four standard deviations";
  EXPECT_GT(rejected, 0) << "it is no test that never rejects";
}

TEST(EnsembleConsistency, HalvedSigmasAreRejected) {
  std::mt19937_64 engine(3);
  const Consistency found = consistency_of(synthetic_epochs(20, 100, 0.5, engine));
  EXPECT_TRUE(found.is_rejected);
  EXPECT_EQ(found.above, 20U) << "NEES is four times as large: every epoch is far above its band";
  const Consistency cautious = consistency_of(synthetic_epochs(20, 100, 2.0, engine));
  EXPECT_TRUE(cautious.is_rejected);
  EXPECT_EQ(cautious.below, 20U);
}

}  // namespace

namespace {

constexpr double kConfidence = 0.95;
constexpr double kPrinted = 5e-5;  // half of the last digit of the published percentages

// Published exact intervals at 95 %, two-sided.
TEST(PassRate, AgreesWithPublishedBounds) {
  EXPECT_NEAR(pass_rate(20, 20, kConfidence).lower, 0.8316, kPrinted);
  EXPECT_NEAR(pass_rate(99, 100, kConfidence).lower, 0.9455, kPrinted);
  EXPECT_NEAR(pass_rate(99, 100, kConfidence).upper, 0.9997, kPrinted);
  EXPECT_NEAR(pass_rate(997, 1000, kConfidence).lower, 0.9913, kPrinted);
  EXPECT_NEAR(pass_rate(997, 1000, kConfidence).upper, 0.9994, kPrinted);
  EXPECT_NEAR(pass_rate(10, 20, kConfidence).lower, 0.2720, kPrinted);
  EXPECT_NEAR(pass_rate(10, 20, kConfidence).upper, 0.7280, kPrinted);
}

TEST(PassRate, HasTheWholeRangeWhereNothingIsKnown) {
  EXPECT_EQ(pass_rate(0, 0, kConfidence).lower, 0.0);
  EXPECT_EQ(pass_rate(0, 0, kConfidence).upper, 1.0);
  EXPECT_EQ(pass_rate(0, 20, kConfidence).lower, 0.0);
  EXPECT_EQ(pass_rate(20, 20, kConfidence).upper, 1.0);
}

/// P(at least `passed` of `of` cases pass), by summation: independent of the beta function that gives the bounds.
double probability_of_at_least(int passed, int of, double rate) {
  double sum = 0.0;
  for (int k = passed; k <= of; ++k)
    sum += std::exp(std::lgamma(of + 1.0) - std::lgamma(k + 1.0) - std::lgamma(of - k + 1.0) + k * std::log(rate) +
                    (of - k) * std::log1p(-rate));
  return sum;
}

// What the bounds are by definition.
TEST(PassRate, LeavesTheStatedProbabilityBeyondEachBound) {
  for (const int of : {1, 2, 7, 40, 300}) {
    for (int passed = 1; passed < of; passed += 1 + of / 7) {
      const auto rate = pass_rate(static_cast<std::size_t>(passed), static_cast<std::size_t>(of), kConfidence);
      // Sums of up to 300 terms of exp(lgamma): 1e-11.
      EXPECT_NEAR(probability_of_at_least(passed, of, rate.lower), 0.025, 1e-10) << passed << " of " << of;
      EXPECT_NEAR(1.0 - probability_of_at_least(passed + 1, of, rate.upper), 0.025, 1e-10) << passed << " of " << of;
    }
  }
}

// Success-run theorem: the numbers that reliability handbooks print for 95 % confidence.
TEST(PassRate, NumberOfCasesThatAClaimNeeds) {
  EXPECT_EQ(cases_needed(0.9, kConfidence), 29U);
  EXPECT_EQ(cases_needed(0.95, kConfidence), 59U);
  EXPECT_EQ(cases_needed(0.99, kConfidence), 299U);
  EXPECT_EQ(cases_needed(0.997, kConfidence), 998U);
  EXPECT_EQ(cases_needed(0.5, 0.75), 2U) << "1 - 0.5^2 is 0.75 exactly";
  EXPECT_GE(one_sided_lower_bound(59, 59, kConfidence), 0.95);
  EXPECT_LT(one_sided_lower_bound(58, 58, kConfidence), 0.95);
}

TEST(PassRate, RefusesWhatIsNoShare) {
  EXPECT_THROW(static_cast<void>(pass_rate(3, 2, kConfidence)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(one_sided_lower_bound(1, 2, 1.0)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(one_sided_lower_bound(1, 2, std::nan(""))), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(cases_needed(1.0, kConfidence)), std::invalid_argument);
}

}  // namespace

namespace {

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

namespace {

using testing::ElementsAre;

TEST(Ranks, EqualValuesShareTheirMeanRank) {
  EXPECT_THAT(ranks({20.0, 10.0, 30.0, 20.0}), ElementsAre(2.5, 1.0, 4.0, 2.5));
  EXPECT_THAT(ranks({7.0, 7.0, 7.0}), ElementsAre(2.0, 2.0, 2.0));
  EXPECT_THAT(ranks({}), ElementsAre());
}

// A worked example of textbooks, by hand: 1 - 6 * 194 / (10 * 99).
TEST(Spearman, AgreesWithAWorkedExample) {
  const auto found = spearman({106, 100, 86, 101, 99, 103, 97, 113, 112, 110}, {7, 27, 2, 50, 28, 29, 20, 12, 6, 17});
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->rho, -29.0 / 165.0, 1e-15);
  EXPECT_NEAR(found->p_value, 0.627188, 5e-7) << "printed with six digits";
  EXPECT_EQ(found->count, 10U);
}

// With ties, by hand: ranks of y are 1.5, 1.5, 3, ..., 10; covariance 82, variances 82.5 and 82.
TEST(Spearman, TakesMeanRanksOfTies) {
  const auto found = spearman({1, 2, 3, 4, 5, 6, 7, 8, 9, 10}, {5, 5, 6, 7, 8, 9, 10, 11, 12, 13});
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->rho, 82.0 / std::sqrt(82.5 * 82.0), 1e-15);
}

// Critical values of Zar (Biostatistical Analysis, table B.20), two-sided. They have three digits, which leave the p
// value uncertain by up to 2.5 %; Student's t approximates the exact distribution to some per cent.
TEST(Spearman, PValuesAgreeWithPublishedCriticalValues) {
  EXPECT_NEAR(spearman_p_value(0.648, 10), 0.05, 0.008);
  EXPECT_NEAR(spearman_p_value(0.447, 20), 0.05, 0.003);
  EXPECT_NEAR(spearman_p_value(0.362, 30), 0.05, 0.002);
  EXPECT_NEAR(spearman_p_value(0.467, 30), 0.01, 0.001);
  EXPECT_NEAR(spearman_p_value(0.197, 100), 0.05, 0.001);
  EXPECT_NEAR(spearman_p_value(0.257, 100), 0.01, 0.0005);
}

TEST(Spearman, LeavesOutPairsWithoutAValue) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> x, y;
  for (int k = 0; k < 12; ++k) {
    x.push_back(k == 3 ? kNan : k);
    y.push_back(k == 5 ? kNan : -std::exp(k));
  }
  const auto found = spearman(x, y);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->count, 10U);
  EXPECT_NEAR(found->rho, -1.0, 1e-15);
  EXPECT_LT(found->p_value, 1e-12);
}

TEST(Spearman, HasNoValueOfTooFewPairsOrAConstant) {
  EXPECT_FALSE(spearman({1, 2, 3, 4, 5, 6, 7, 8, 9}, {1, 2, 3, 4, 5, 6, 7, 8, 9}));
  EXPECT_FALSE(spearman(std::vector<double>(20, 1.0), std::vector<double>(20, 2.0)));
  EXPECT_FALSE(spearman({}, {}));
}

// The example of R's p.adjust for Holm, by hand: 4 * 0.005, 3 * 0.01, 2 * 0.03, and 0.06 as it must not fall.
TEST(Holm, CorrectsForTheNumberOfTests) {
  EXPECT_THAT(holm({0.01, 0.04, 0.03, 0.005}), ElementsAre(testing::DoubleEq(0.03), testing::DoubleEq(0.06),
                                                           testing::DoubleEq(0.06), testing::DoubleEq(0.02)));
  EXPECT_THAT(holm({0.6, 0.7}), ElementsAre(1.0, 1.0));
  EXPECT_THAT(holm({}), ElementsAre());
}

// Figures that depend on nothing: one of twenty keys seems to drive them in at most 5 % of the campaigns.
TEST(Holm, SeldomNamesADriverWhereThereIsNone) {
  constexpr int kCampaigns = 400, kKeys = 20, kCases = 40;
  std::mt19937_64 engine(3);
  std::normal_distribution<double> normal;
  const auto draws = [&] {
    std::vector<double> values(kCases);
    for (double& value : values) value = normal(engine);
    return values;
  };
  int wrong = 0;
  for (int campaign = 0; campaign < kCampaigns; ++campaign) {
    const std::vector<double> figure = draws();
    std::vector<double> p_values;
    for (int key = 0; key < kKeys; ++key) p_values.push_back(spearman(draws(), figure)->p_value);
    bool names_one = false;
    for (const double p : holm(p_values)) names_one = names_one || p < 0.05;
    wrong += names_one ? 1 : 0;
  }
  EXPECT_LE(wrong, 0.05 * kCampaigns + 4.0 * std::sqrt(0.05 * 0.95 * kCampaigns)) << "four standard deviations";
  EXPECT_GT(wrong, 0) << "it is no correction that never names one";
}

}  // namespace

}  // namespace vbar::campaign_report::test
