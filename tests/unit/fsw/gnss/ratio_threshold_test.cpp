// The ratio test's table against the one case that has a formula and against models that it was not simulated with; the
// chi-square tail against the printed tables.

#include "fsw/gnss/ratio_threshold.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include <gtest/gtest.h>

#include "fsw/gnss/chi_square.h"
#include "fsw/gnss/decorrelation.h"
#include "fsw/gnss/lambda.h"
#include "tests/support/accuracy.h"
#include "tests/unit/fsw/gnss/ambiguity_problems.h"

namespace vbar::fsw::gnss {
namespace {

/// Standard deviation of one ambiguity that rounding misses at the given rate.
double sigma_of(double failure_rate) {
  double low = 0.01;
  double high = 10.0;
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (low + high);
    (std::erfc(0.5 / (middle * std::sqrt(2.0))) < failure_rate ? low : high) = middle;
  }
  return low;
}

/// One ambiguity of truth 0: the ratio is ((1 - e) / e)^2 at a distance e from the nearest integer, so wrong integers
/// are accepted at floats within 1 / (1 + sqrt(ratio)) of any other integer.
double wrong_and_accepted(double sigma, double ratio) {
  const double reach = 1.0 / (1.0 + std::sqrt(ratio));
  double sum = 0.0;
  for (int z = 1; z <= 20; ++z) {
    const double scale = 1.0 / (sigma * std::sqrt(2.0));
    sum += std::erfc((z - reach) * scale) - std::erfc((z + reach) * scale);  // both signs of z
  }
  return sum;
}

TEST(RatioThreshold, KeepsTheFailureRateOfOneAmbiguity) {
  for (const double failure_rate : {0.002, 0.005, 0.01, 0.02, 0.05, 0.1}) {
    const double rate = wrong_and_accepted(sigma_of(failure_rate), ratio_threshold(1, failure_rate));
    // Simulated with 100 events an entry, the strictest of 12: 10 % of scatter each, so within -40 % and +10 %.
    EXPECT_GT(rate, 0.6 * kFixFailureRate) << failure_rate;
    EXPECT_LT(rate, 1.1 * kFixFailureRate) << failure_rate;
  }
}

TEST(RatioThreshold, IsStricterForFewerAmbiguitiesAndWeakerModels) {
  for (std::size_t n = 1; n <= kMaxAmbiguities; ++n) {
    EXPECT_EQ(ratio_threshold(n, 0.0), 1.0);
    EXPECT_EQ(ratio_threshold(n, kFixFailureRate), 1.0);
    double before = 1.0;
    for (double rate = kFixFailureRate; rate <= kLargestModelFailureRate; rate *= 1.05) {
      EXPECT_GE(ratio_threshold(n, rate), before);
      before = ratio_threshold(n, rate);
      if (n > 1) {
        EXPECT_LE(ratio_threshold(n, rate), ratio_threshold(n - 1, rate));
      }
    }
  }
}

TEST(RatioThreshold, ReachesNowhereWhatItWasNotMadeFor) {
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(ratio_threshold(0, 0.01), infinity);
  EXPECT_EQ(ratio_threshold(8, 0.11), infinity);
  EXPECT_EQ(ratio_threshold(8, std::numeric_limits<double>::quiet_NaN()), infinity);
  EXPECT_EQ(ratio_threshold(8, 1.0), infinity);
}

TEST(RatioThreshold, KeepsTheFailureRateOfModelsItWasNotSimulatedWith) {
  problems::Random random(77);
  constexpr int kDraws = 1000;
  int wrong = 0;
  int accepted = 0;
  int drawn = 0;
  for (int model = 0; model < 30; ++model) {
    const Eigen::Index n = std::uniform_int_distribution<Eigen::Index>(4, 24)(random);
    problems::Matrix q = problems::random_session_covariance(n, random);
    const problems::Vector zero = problems::Vector::Zero(n);
    double failure_rate = 0.0;
    const double wanted = std::pow(10.0, problems::uniform(random, -2.7, -1.0));
    for (int step = 0; step < 400 && failure_rate < wanted; ++step) {  // weaker until it fails that often
      Decorrelation problem;
      q *= 1.05;
      ASSERT_EQ(
          problem.compute({zero.data(), static_cast<std::size_t>(n)}, {q.data(), static_cast<std::size_t>(n * n)}),
          Status::kOk);
      failure_rate = 1.0 - bootstrap_success_rate(problem.d());
    }
    const double threshold = ratio_threshold(static_cast<std::size_t>(n), failure_rate);
    for (int draw = 0; draw < kDraws; ++draw) {
      const problems::Problem problem = problems::draw(q, random);
      const IntegerSolution solution =
          resolve_ambiguities({problem.ambiguities.data(), problem.size()}, {q.data(), problem.size() * problem.size()})
              .value();
      ++drawn;
      if (solution.second_norm2 < threshold * solution.best_norm2) continue;
      ++accepted;
      if (!std::equal(problem.integers.begin(), problem.integers.end(), solution.best.begin())) ++wrong;
    }
  }
  accuracy::expect_below("ratio test, rate of wrong integers accepted", "simulated truth, 30,000 problems of 30 models",
                         static_cast<double>(wrong) / drawn, kFixFailureRate, "of problems");
  EXPECT_GT(accepted, drawn / 2);
}

TEST(ChiSquare, TailIsThatOfThePrintedTables) {
  // Abramowitz and Stegun, table 26.8: x for a tail of 0.05 and of 0.001, given with six and five digits.
  struct Row {
    std::size_t degrees;
    double x05, x001;
  };
  for (const Row& row : {Row{1, 3.84146, 10.828}, Row{2, 5.99147, 13.816}, Row{5, 11.0705, 20.515},
                         Row{10, 18.3070, 29.588}, Row{24, 36.4151, 51.179}}) {
    EXPECT_NEAR(chi_square_tail(row.x05, row.degrees), 0.05, 0.05 * 1e-5 * row.x05) << row.degrees;
    EXPECT_NEAR(chi_square_tail(row.x001, row.degrees), 0.001, 0.001 * 5e-4) << row.degrees;
  }
  EXPECT_EQ(chi_square_tail(0.0, 7), 1.0);
  EXPECT_EQ(chi_square_tail(0.0, 8), 1.0);
  EXPECT_EQ(chi_square_tail(1e6, 24), 0.0);
  // One more degree of freedom by the density: Q(x, v + 2) - Q(x, v) = (x/2)^(v/2) exp(-x/2) / Gamma(v/2 + 1), 26.4.8.
  for (std::size_t v = 1; v <= 22; ++v) {
    const double x = 0.7 * static_cast<double>(v) + 1.0;
    const double half = 0.5 * static_cast<double>(v);
    EXPECT_NEAR(chi_square_tail(x, v + 2) - chi_square_tail(x, v),
                std::exp(half * std::log(0.5 * x) - 0.5 * x - std::lgamma(half + 1.0)), 1e-14);
  }
}

}  // namespace
}  // namespace vbar::fsw::gnss
