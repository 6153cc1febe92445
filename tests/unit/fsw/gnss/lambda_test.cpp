// Integer least squares against published numbers, against enumeration and against what must hold for any problem.

#include "fsw/gnss/lambda.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/accuracy.h"
#include "tests/support/allocation_counter.h"
#include "tests/unit/fsw/gnss/ambiguity_problems.h"

namespace vbar::fsw::gnss {
namespace {

using problems::Matrix;
using problems::Problem;
using problems::Random;
using problems::Vector;

std::span<const double> view(const Vector& v) {
  return {v.data(), static_cast<std::size_t>(v.size())};
}
std::span<const double> view(const Matrix& m) {
  return {m.data(), static_cast<std::size_t>(m.size())};
}
Result<IntegerSolution> resolve(const Problem& problem) {
  return resolve_ambiguities(view(problem.ambiguities), view(problem.covariance));
}
Vector whole(const std::array<double, kMaxAmbiguities>& z, std::size_t n) {
  return Eigen::Map<const Vector>(z.data(), static_cast<Eigen::Index>(n));
}
double norm2(const Problem& problem, const Vector& z) {
  const Vector residual = problem.ambiguities - z;
  return residual.dot(problem.covariance.ldlt().solve(residual));
}

/// De Jonge and Tiberius 1996, "The LAMBDA method for integer ambiguity estimation: implementation aspects", section 3.
Problem de_jonge_tiberius() {
  Problem problem;
  problem.ambiguities.resize(3);
  problem.ambiguities << 5.45, 3.10, 2.97;
  problem.covariance.resize(3, 3);
  problem.covariance << 6.290, 5.978, 0.544, 5.978, 6.292, 2.340, 0.544, 2.340, 6.288;
  return problem;
}

TEST(Lambda, SolvesTheExampleOfDeJongeAndTiberius) {
  const Result<IntegerSolution> solution = resolve(de_jonge_tiberius());
  ASSERT_TRUE(solution.ok());
  EXPECT_EQ(whole(solution.value().best, 3), Vector(Eigen::Vector3d(5, 3, 4)));
  EXPECT_EQ(whole(solution.value().second, 3), Vector(Eigen::Vector3d(6, 4, 4)));
  EXPECT_NEAR(solution.value().best_norm2, 0.2183, 5e-5);  // printed with four decimals
  EXPECT_NEAR(solution.value().second_norm2, 0.3073, 5e-5);
}

/// The two nearest by trying every whole vector that can be as near as two that are known.
std::array<double, 2> enumerate(const Problem& problem, std::array<Vector, 2>& nearest) {
  const Eigen::Index n = problem.ambiguities.size();
  const Matrix inverse = problem.covariance.inverse();
  const auto distance2 = [&](const Vector& z) {
    const Vector residual = problem.ambiguities - z;
    return residual.dot(inverse * residual);
  };
  Vector rounded = problem.ambiguities.array().round();
  accuracy::Largest bound(distance2(rounded));
  rounded(0) += 1.0;
  bound.add(distance2(rounded));
  // |a - z|_i <= sqrt(bound Q_ii) inside the ellipsoid.
  const Vector reach = (bound * problem.covariance.diagonal()).array().sqrt();
  const Vector low = (problem.ambiguities - reach).array().ceil();
  const Vector high = (problem.ambiguities + reach).array().floor();
  std::array<double, 2> best{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  for (Vector z = low;;) {
    const double d = distance2(z);
    if (d < best[0]) {
      best = {d, best[0]};
      nearest = {z, nearest[0]};
    } else if (d < best[1]) {
      best[1] = d;
      nearest[1] = z;
    }
    Eigen::Index i = 0;
    while (i < n && ++z(i) > high(i)) {
      z(i) = low(i);
      ++i;
    }
    if (i == n) return best;
  }
}

TEST(Lambda, FindsTheTwoNearestThatEnumerationFinds) {
  Random random(1);
  accuracy::Largest largest;
  for (Eigen::Index n = 1; n <= 4; ++n) {
    for (int trial = 0; trial < 200; ++trial) {
      const Problem problem = problems::draw(problems::random_covariance(n, 1.5, 2.0, random), random);
      std::array<Vector, 2> nearest;
      const std::array<double, 2> distance2 = enumerate(problem, nearest);
      const Result<IntegerSolution> solution = resolve(problem);
      ASSERT_TRUE(solution.ok());
      EXPECT_EQ(whole(solution.value().best, problem.size()), nearest[0]);
      EXPECT_EQ(whole(solution.value().second, problem.size()), nearest[1]);
      largest.add(std::abs(solution.value().best_norm2 - distance2[0]) / distance2[1],
                  std::abs(solution.value().second_norm2 - distance2[1]) / distance2[1]);
    }
  }
  // Floats of 10^5 cycles are known to 1.5e-11, of residuals of 0.1 to 1: 1e-10 relative, a little more in the square.
  accuracy::expect_below("LAMBDA, squared norms of the two nearest integer vectors",
                         "enumeration, 800 problems, n <= 4", largest, 1e-9, "relative");
}

/// Z^-T, from the images of unit vectors of a problem whose float ambiguities are zero.
Matrix back_transformation(const Decorrelation& problem) {
  const auto n = static_cast<Eigen::Index>(problem.count());
  Matrix back = Matrix::Identity(n, n);
  for (Eigen::Index k = 0; k < n; ++k) {
    EXPECT_EQ(problem.to_original({back.col(k).data(), problem.count()}), Status::kOk);
  }
  return back;
}

Matrix triangle(const Decorrelation& problem) {
  const auto n = static_cast<Eigen::Index>(problem.count());
  Matrix l = Matrix::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) l(i, j) = problem.l().row(static_cast<std::size_t>(i))[j];
  }
  return l;
}

TEST(Decorrelation, IsAWholeTransformationThatKeepsVolumeAndCovariance) {
  Random random(2);
  for (const Eigen::Index n : {1, 2, 8, 24}) {
    for (int trial = 0; trial < 20; ++trial) {
      const Matrix covariance = problems::random_session_covariance(std::max<Eigen::Index>(n, 3), random);
      const Matrix q = covariance.topLeftCorner(n, n);
      Decorrelation problem;
      ASSERT_EQ(problem.compute(view(Vector(Vector::Zero(n))), view(q)), Status::kOk);
      const Matrix back = back_transformation(problem);
      EXPECT_EQ(back, Matrix(back.array().round()));
      // Of whole numbers up to 1e4; LU in doubles leaves 1e-9 of a determinant of 1.
      EXPECT_NEAR(std::abs(back.determinant()), 1.0, 1e-6);
      const Matrix l = triangle(problem);
      const Vector d = Eigen::Map<const Vector>(problem.d().data(), n);
      const Matrix restored = back * l.transpose() * d.asDiagonal() * l * back.transpose();
      // Whole numbers up to 1e4 twice on rounding of 1e-16 of the decorrelated variances.
      EXPECT_LT(accuracy::largest_entry(restored - q), 1e-8 * accuracy::largest_entry(q));
    }
  }
}

TEST(Decorrelation, SharpensTheConditionalVariances) {
  Random random(3);
  for (int trial = 0; trial < 50; ++trial) {
    const Matrix q = problems::random_session_covariance(12, random);
    Decorrelation problem;
    ASSERT_EQ(problem.compute(view(Vector(Vector::Zero(12))), view(q)), Status::kOk);
    // Lovasz' condition, what the reduction promises: D(k) + l^2 D(k+1) >= 0.99 D(k+1), l within a half.
    for (std::size_t k = 0; k + 1 < 12; ++k) EXPECT_GE(problem.d()[k], (0.99 - 0.25) * problem.d()[k + 1] * (1 - 1e-9));
    // The volume is no matter of the transformation (Teunissen 1997): det Q = prod D.
    EXPECT_NEAR(std::log(adop(problem.d())), q.ldlt().vectorD().array().log().sum() / 24.0, 1e-6);
  }
}

TEST(Lambda, GivesTheSameForFloatsMovedByWholeNumbers) {
  Random random(4);
  for (int trial = 0; trial < 50; ++trial) {
    const Matrix q = problems::random_session_covariance(8, random);
    Problem problem = problems::draw(q, random);
    problem.ambiguities = (problem.ambiguities * 1048576.0).array().round() / 1048576.0;  // so that sums are exact
    const IntegerSolution here = resolve(problem).value();
    const Vector shift = (1e6 * problems::standard_normal(random, 8)).array().round();
    problem.ambiguities += shift;
    const IntegerSolution there = resolve(problem).value();
    EXPECT_EQ(whole(there.best, 8), Vector(whole(here.best, 8) + shift));
    EXPECT_EQ(whole(there.second, 8), Vector(whole(here.second, 8) + shift));
    EXPECT_EQ(there.best_norm2, here.best_norm2);
    EXPECT_EQ(there.second_norm2, here.second_norm2);
  }
}

TEST(Lambda, NormsAreThoseOfItsIntegersInTheGivenCovariance) {
  Random random(5);
  for (const Eigen::Index n : {8, 24}) {
    for (int trial = 0; trial < 50; ++trial) {
      const Problem problem = problems::draw(problems::random_session_covariance(n, random), random);
      const IntegerSolution solution = resolve(problem).value();
      EXPECT_LE(solution.best_norm2, solution.second_norm2);
      // Condition numbers up to 1e8 on rounding of 1e-16, and floats of 1e5 cycles against deviations of 1e-2.
      EXPECT_NEAR(solution.best_norm2 / norm2(problem, whole(solution.best, problem.size())), 1.0, 1e-5);
      EXPECT_NEAR(solution.second_norm2 / norm2(problem, whole(solution.second, problem.size())), 1.0, 1e-5);
    }
  }
}

/// Sequential conditional rounding in the decorrelated space, by the covariance alone: what the success rate is of.
bool bootstrap(const Matrix& q, Vector z) {
  Matrix p = q;
  for (Eigen::Index k = q.rows(); k-- > 0;) {
    const double miss = z(k);
    if (!(std::abs(miss) < 0.5)) return false;  // the true integers are zero
    z.head(k) -= p.col(k).head(k) * (miss / p(k, k));
    p.topLeftCorner(k, k) -= (p.col(k).head(k) * p.col(k).head(k).transpose() / p(k, k)).eval();
  }
  return true;
}

TEST(Lambda, SuccessRateIsThatOfBootstrappingAndBoundsLeastSquares) {
  Random random(6);
  constexpr int kTrials = 4000;
  int weak = 0;
  for (int model = 0; model < 200 && weak < 8; ++model) {
    const Eigen::Index n = model % 2 == 0 ? 6 : 12;
    const Matrix q = problems::random_session_covariance(n, random);
    Decorrelation problem;
    ASSERT_EQ(problem.compute(view(Vector(Vector::Zero(n))), view(q)), Status::kOk);
    const double rate = bootstrap_success_rate(problem.d());
    if (rate < 0.2 || rate > 0.99) continue;  // statistics want failures and successes
    ++weak;
    const Matrix forth = back_transformation(problem).inverse();
    const Matrix qz = forth * q * forth.transpose();
    const Eigen::LLT<Matrix> factor(q);
    int bootstrapped = 0;
    int least_squares = 0;
    for (int trial = 0; trial < kTrials; ++trial) {
      const Vector a = factor.matrixL() * problems::standard_normal(random, n);
      if (bootstrap(qz, forth * a)) ++bootstrapped;
      const Result<IntegerSolution> solution = resolve_ambiguities(view(a), view(q));
      ASSERT_TRUE(solution.ok());
      if (whole(solution.value().best, static_cast<std::size_t>(n)).isZero()) ++least_squares;
    }
    // Binomial, four standard deviations: 1 in 16,000 for a model.
    const double spread = 4.0 * std::sqrt(rate * (1.0 - rate) / kTrials);
    EXPECT_NEAR(static_cast<double>(bootstrapped) / kTrials, rate, spread) << "n " << n;
    EXPECT_GE(static_cast<double>(least_squares) / kTrials, rate - spread) << "n " << n;
  }
  EXPECT_EQ(weak, 8) << "too few models between a success rate of 0.2 and 0.99";
}

TEST(Lambda, RefusesWhatIsNoProblem) {
  const Problem good = de_jonge_tiberius();
  const auto status = [](const Vector& a, const Matrix& q) { return resolve_ambiguities(view(a), view(q)).status(); };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(status(Vector(), Matrix()), Status::kInvalidArgument);
  EXPECT_EQ(status(Vector::Zero(2), good.covariance), Status::kInvalidArgument);
  EXPECT_EQ(status(Vector::Zero(25), Matrix::Identity(25, 25)), Status::kInvalidArgument);
  for (const double bad : {nan, infinity, -infinity}) {
    Vector a = good.ambiguities;
    a(1) = bad;
    EXPECT_EQ(status(a, good.covariance), Status::kNotFinite);
    Matrix q = good.covariance;
    q(2, 1) = bad;
    EXPECT_EQ(status(good.ambiguities, q), Status::kNotFinite);
  }
  EXPECT_EQ(status(Eigen::Vector3d(0.0, 1e16, 0.0), good.covariance), Status::kOutOfRange);
  EXPECT_EQ(status(good.ambiguities, Matrix::Zero(3, 3)), Status::kSingular);
  EXPECT_EQ(status(good.ambiguities, -good.covariance), Status::kSingular);
  EXPECT_EQ(status(good.ambiguities, Matrix::Ones(3, 3)), Status::kSingular);
  Matrix indefinite = good.covariance;
  indefinite(1, 0) = 7.0;  // a correlation above one
  EXPECT_EQ(status(good.ambiguities, indefinite), Status::kSingular);
  EXPECT_EQ(status(good.ambiguities, 1e-310 * good.covariance), Status::kSingular);  // 1 / d overflows
}

TEST(Lambda, EndsOnCovariancesOfEveryScaleAndRank) {
  // Whatever the numbers: an answer that keeps its promises, or a status.
  Random random(7);
  int solved = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const Eigen::Index n = std::uniform_int_distribution<Eigen::Index>(1, 24)(random);
    Matrix q = problems::random_covariance(n, problems::uniform(random, 0.0, 18.0), 1.0, random);
    Vector scale(n);
    for (double& s : scale) s = std::pow(10.0, problems::uniform(random, -4.0, 4.0));
    q = (scale.asDiagonal() * q * scale.asDiagonal()).eval();
    const Vector a = 100.0 * problems::standard_normal(random, n);
    const Result<IntegerSolution> solution = resolve_ambiguities(view(a), view(q));
    if (!solution.ok()) continue;
    ++solved;
    for (std::size_t i = 0; i < static_cast<std::size_t>(n); ++i) {
      EXPECT_EQ(solution.value().best[i], std::round(solution.value().best[i]));
      EXPECT_LT(std::abs(solution.value().best[i]), 9007199254740992.0);
    }
    EXPECT_LE(solution.value().best_norm2, solution.value().second_norm2);
    EXPECT_GE(solution.value().success_rate, 0.0);
    EXPECT_LE(solution.value().success_rate, 1.0);
  }
  EXPECT_GT(solved, 50);
}

TEST(Lambda, ReadsTheLowerTriangleOnly) {
  Problem problem = de_jonge_tiberius();
  const IntegerSolution whole_matrix = resolve(problem).value();
  problem.covariance.triangularView<Eigen::StrictlyUpper>().setConstant(-1e9);
  EXPECT_EQ(resolve(problem).value().best, whole_matrix.best);
  EXPECT_EQ(resolve(problem).value().best_norm2, whole_matrix.best_norm2);
}

TEST(Lambda, AsksNothingOfTheHeap) {
  Random random(8);
  const Problem problem = problems::draw(problems::random_session_covariance(24, random), random);
  const std::size_t before = vbar::test::allocation_count();
  const bool ok = resolve(problem).ok();
  EXPECT_EQ(vbar::test::allocation_count(), before);
  EXPECT_TRUE(ok);
}

}  // namespace
}  // namespace vbar::fsw::gnss
