#include "host_sim/campaign_report/rank_correlation.h"

#include <cmath>
#include <limits>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace vbar::campaign_report::test {
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
