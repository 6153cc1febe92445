#include "host_sim/campaign_report/pass_rate.h"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

namespace vbar::campaign_report::test {
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
}  // namespace vbar::campaign_report::test
