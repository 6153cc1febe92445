// Bounded least squares against the conditions of a minimum (Karush, Kuhn, Tucker), which for a convex problem are
// sufficient, and against the best of all sets of bounds.

#include "hil_drivers/tron/lights/bounded_least_squares.h"

#include <cmath>
#include <limits>
#include <random>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "tests/support/figures.h"

namespace vbar::tron {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

struct Problem {
  MatrixXd A;
  VectorXd b;
};

Problem random_problem(std::mt19937& random, Index rows, Index columns) {
  std::normal_distribution<double> normal;
  Problem problem{MatrixXd(rows, columns), VectorXd(rows)};
  for (double& entry : problem.A.reshaped()) entry = std::abs(normal(random));
  VectorXd x(columns);
  for (double& entry : x) entry = 0.5 + normal(random);
  for (double& entry : problem.b) entry = 0.3 * normal(random);
  problem.b += problem.A * x;
  return problem;
}

/// Largest violation of the conditions of a minimum, relative.
double violation(const Problem& problem, const VectorXd& x) {
  const VectorXd descent = problem.A.transpose() * (problem.b - problem.A * x);
  accuracy::Largest worst;
  for (Index k = 0; k < x.size(); ++k) {
    if (!(x[k] >= 0.0 && x[k] <= 1.0)) return std::numeric_limits<double>::infinity();
    const double scale = problem.A.col(k).norm() * (problem.b.norm() + problem.A.norm());
    double excess = std::abs(descent[k]);
    if (x[k] == 0.0) excess = std::max(0.0, descent[k]);
    if (x[k] == 1.0) excess = std::max(0.0, -descent[k]);
    if (scale > 0.0) worst.add(excess / scale);
  }
  return worst;
}

TEST(BoundedLeastSquares, MeetsTheConditionsOfAMinimum) {
  std::mt19937 random(7);
  for (int trial = 0; trial < 5000; ++trial) {
    const auto problem = random_problem(random, trial % 2 == 0 ? 162 : 12, 1 + trial % 12);
    const BoundedSolution solution = bounded_least_squares(problem.A, problem.b);
    ASSERT_TRUE(solution.has_converged) << trial;
    ASSERT_LT(violation(problem, solution.x), 1e-11) << trial;
    ASSERT_NEAR(solution.residual_norm, (problem.A * solution.x - problem.b).norm(), 1e-12);
  }
}

/// The smallest residual over all 3^n choices of which variable is at which bound or free.
double best_of_all_sets(const Problem& problem) {
  const Index n = problem.A.cols();
  accuracy::Smallest best;
  for (int code = 0; code < static_cast<int>(std::lround(std::pow(3, n))); ++code) {
    VectorXd x = VectorXd::Zero(n);
    std::vector<Index> free;
    for (Index k = 0, rest = code; k < n; ++k, rest /= 3) {
      if (rest % 3 == 1) x[k] = 1.0;
      if (rest % 3 == 2) free.push_back(k);
    }
    if (!free.empty()) {
      const VectorXd part = problem.A(Eigen::all, free).colPivHouseholderQr().solve(problem.b - problem.A * x);
      x(free) = part;
    }
    if (!((x.array() >= 0.0).all() && (x.array() <= 1.0).all())) continue;
    best.add((problem.A * x - problem.b).norm());
  }
  return best;
}

TEST(BoundedLeastSquares, FindsTheBestOfAllSetsOfBounds) {
  std::mt19937 random(8);
  for (int trial = 0; trial < 200; ++trial) {
    const auto problem = random_problem(random, 9, 5);
    EXPECT_NEAR(bounded_least_squares(problem.A, problem.b).residual_norm, best_of_all_sets(problem), 1e-11);
  }
}

// Two equal columns, and one that is zero: the minimum is reached, although x is not unique.
TEST(BoundedLeastSquares, ReachesTheMinimumWithDependentColumns) {
  std::mt19937 random(9);
  for (int trial = 0; trial < 1000; ++trial) {
    auto problem = random_problem(random, 20, 6);
    problem.A.col(3) = problem.A.col(1);
    problem.A.col(4).setZero();
    const BoundedSolution solution = bounded_least_squares(problem.A, problem.b);
    ASSERT_TRUE(solution.has_converged);
    ASSERT_LT(violation(problem, solution.x), 1e-11) << trial;
    EXPECT_EQ(solution.x[4], 0.0);
  }
}

TEST(BoundedLeastSquares, OfZeroIsZero) {
  const BoundedSolution solution = bounded_least_squares(MatrixXd::Ones(3, 2), VectorXd::Zero(3));
  EXPECT_TRUE(solution.x.isZero());
}

TEST(BoundedLeastSquares, RefusesWhatIsNotFinite) {
  MatrixXd A = MatrixXd::Ones(3, 2);
  VectorXd b = VectorXd::Ones(3);
  b[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW((void)bounded_least_squares(A, b), std::invalid_argument);
  EXPECT_THROW((void)bounded_least_squares(A, VectorXd::Ones(2)), std::invalid_argument);
  EXPECT_THROW((void)bounded_least_squares(MatrixXd::Ones(1, 2), VectorXd::Ones(1)), std::invalid_argument);
}

}  // namespace
}  // namespace vbar::tron
