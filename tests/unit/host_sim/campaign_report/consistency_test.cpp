#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "host_sim/campaign_report/ensemble_consistency.h"

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
}  // namespace vbar::campaign_report::test
