// The same integers as RTKLIB's lambda(), which decorrelates fully and searches after Chang, Yang and Zhou as well.

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>

#include <gtest/gtest.h>

#include "fsw/gnss/lambda.h"
#include "tests/support/accuracy.h"
#include "tests/unit/fsw/gnss/ambiguity_problems.h"

#ifdef VBAR_HAVE_RTKLIB
#include "tests/peers/rtklib/rtklib_lambda.h"
#endif

namespace vbar::fsw::gnss {
namespace {

#ifdef VBAR_HAVE_RTKLIB

using problems::Problem;
using problems::Random;

struct Comparison {
  int compared = 0;
  int unanswered = 0;  ///< by RTKLIB
  int different = 0;
  accuracy::Largest largest_norm_difference;
};

/// Best and second, as whole vectors; RTKLIB's come out of a solution of linear equations, so they are rounded first.
bool same_integers(const IntegerSolution& ours, const Eigen::MatrixXd& theirs) {
  const Eigen::Index n = theirs.rows();
  const Eigen::Map<const Eigen::VectorXd> best(ours.best.data(), n);
  const Eigen::Map<const Eigen::VectorXd> second(ours.second.data(), n);
  return best == Eigen::VectorXd(theirs.col(0).array().round()) &&
         second == Eigen::VectorXd(theirs.col(1).array().round());
}

/// 1000 problems that RTKLIB answers.
template <class DrawCovariance>
Comparison compare(Eigen::Index n, std::uint64_t seed, const DrawCovariance& covariance) {
  Random random(seed);
  Comparison result;
  Eigen::MatrixXd theirs(n, 2);
  std::array<double, 2> norm2{};
  while (result.compared < 1000 && result.unanswered < 1000) {
    const Problem problem = problems::draw(covariance(random), random);
    const bool answered = peers::rtklib_lambda(problem.ambiguities, problem.covariance, theirs, norm2);
    const Result<IntegerSolution> ours = resolve_ambiguities(
        {problem.ambiguities.data(), problem.size()}, {problem.covariance.data(), problem.size() * problem.size()});
    if (!answered) {
      ++result.unanswered;
      continue;
    }
    ++result.compared;
    if (!ours.ok() || !same_integers(ours.value(), theirs)) {
      ++result.different;
      continue;
    }
    result.largest_norm_difference.add(std::abs(ours.value().best_norm2 / norm2[0] - 1.0),
                                       std::abs(ours.value().second_norm2 / norm2[1] - 1.0));
  }
  return result;
}

void expect_same(const std::string& kind, Eigen::Index n, const Comparison& comparison) {
  EXPECT_EQ(comparison.compared, 1000) << comparison.unanswered << " not answered by RTKLIB";
  accuracy::expect_count("LAMBDA, integers that differ, " + kind + ", " + std::to_string(n) + " ambiguities",
                         "RTKLIB lambda(), 1000 problems", comparison.different, 0, "problems");
  // Both lose up to ten digits to the condition of the covariance and to floats of 10^5 cycles.
  EXPECT_LE(comparison.largest_norm_difference, 1e-5);
}

class LambdaPeer : public testing::TestWithParam<int> {};

TEST_P(LambdaPeer, FindsTheSameIntegersForSatelliteGeometry) {
  const Eigen::Index n = GetParam();
  expect_same("satellite geometry", n, compare(n, 10 + static_cast<std::uint64_t>(n), [n](Random& random) {
                return problems::random_session_covariance(n, random);
              }));
}

TEST_P(LambdaPeer, FindsTheSameIntegersForArbitraryCovariances) {
  const Eigen::Index n = GetParam();
  expect_same("arbitrary covariances", n, compare(n, 50 + static_cast<std::uint64_t>(n), [n](Random& random) {
                return problems::random_covariance(n, problems::uniform(random, 0.0, 4.0),
                                                   std::pow(10.0, problems::uniform(random, -2.0, 0.0)), random);
              }));
}

INSTANTIATE_TEST_SUITE_P(Sizes, LambdaPeer, testing::Values(8, 12, 20, 24),
                         [](const auto& size) { return std::to_string(size.param); });

#else

TEST(LambdaPeer, FindsTheSameIntegersAsRtklib) {
  GTEST_SKIP() << "Debian's librtklib-dev is not installed";
}

#endif

}  // namespace
}  // namespace vbar::fsw::gnss
