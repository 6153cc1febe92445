// Tests of two samples against values published or computed elsewhere.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "host_sim/verification/compare.h"

namespace vbar::verification {
namespace {

// Ages at the diagnosis of diabetes, the example of scipy.stats.mannwhitneyu (SciPy 1.11): U = 17 of 20, two-sided p of
// 0.1111 exactly, 0.11134688653314041 by the normal approximation with continuity correction. One-sided: half of it.
const std::vector<double> kFemales{20, 11, 17, 12}, kMales{19, 22, 16, 29, 24};

TEST(MannWhitney, HasTheExactProbabilityOfThePublishedExample) {
  EXPECT_NEAR(mann_whitney_p(kFemales, kMales), 0.5 / 9.0, 1e-12);
}

// Mann and Whitney (1947), table I: of 126 arrangements of 5 and 4 values one has U = 0.
TEST(MannWhitney, OfSeparateSamplesIsOneArrangement) {
  EXPECT_NEAR(mann_whitney_p({1, 2, 3, 4}, {5, 6, 7, 8, 9}), 1.0 / 126.0, 1e-12);
  EXPECT_NEAR(mann_whitney_p({5, 6, 7, 8, 9}, {1, 2, 3, 4}), 1.0, 1e-12);
}

// Normal approximation by hand: 10 against 10 with a pair of equal values across the samples. U = 0.5 + 99 of 100; mean
// 50, variance 100 / 12 (21 - 6 / 380); z = (99.5 - 50.5) / sqrt(174.8684) = 3.70544; p = 1.0553e-4.
TEST(MannWhitney, CorrectsForEqualValuesAndContinuity) {
  const std::vector<double> earlier{1, 2, 3, 4, 5, 6, 7, 8, 9, 10}, later{10, 11, 12, 13, 14, 15, 16, 17, 18, 19};
  EXPECT_NEAR(mann_whitney_p(earlier, later), 0.5 * std::erfc(3.70544 / std::sqrt(2.0)), 1e-8);
}

TEST(MannWhitney, TakesALostCaseForTheWorst) {
  const double lost = std::numeric_limits<double>::infinity();
  EXPECT_NEAR(mann_whitney_p({1, 2, 3}, {4, 5, lost}), 1.0 / 20.0, 1e-12);
  EXPECT_EQ(mann_whitney_p({}, {1.0}), 1.0);
  EXPECT_EQ(mann_whitney_p({1, 1, 1}, {1, 1, 1}), 1.0);
}

// Fisher (1935), the lady tasting tea: 3 of 4 against 1 of 4, p = 17/70.
TEST(FisherExact, HasThePublishedProbabilities) {
  EXPECT_NEAR(fisher_p(3, 4, 1, 4), 17.0 / 70.0, 1e-12);
  // scipy.stats.fisher_exact([[8, 2], [1, 5]], "greater"): 0.024475524.
  EXPECT_NEAR(fisher_p(8, 10, 1, 6), 0.024475524475524, 1e-12);
  EXPECT_NEAR(fisher_p(10, 10, 10, 10), 1.0, 1e-12);
  EXPECT_EQ(fisher_p(0, 0, 1, 2), 1.0);
}

}  // namespace
}  // namespace vbar::verification
