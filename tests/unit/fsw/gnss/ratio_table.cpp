// Simulates the table of fsw/gnss/ambiguity_validation.cpp: the ratio of second-best to best squared norm that the
// integers must reach so that wrong ones are accepted in no more than 1 of 1000 problems (the ratio test with fixed
// failure rate of Teunissen and Verhagen 2009), by number of ambiguities and by the failure rate of bootstrapping.
//
//   ninja -C build/host vbar_ratio_table && build/host/tests/unit/fsw/gnss/vbar_ratio_table
//
// For every entry, models of both kinds of ambiguity_problems.h are scaled to the failure rate; of each, 100,000
// problems are drawn and the smallest sufficient ratio noted; the entry is the largest of these, and of those of more
// ambiguities and stronger models, since a user takes the entry of the next fewer and the next weaker. Takes some ten
// minutes.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <vector>

#include "fsw/gnss/lambda.h"
#include "tests/support/figures.h"
#include "tests/unit/fsw/gnss/ambiguity_problems.h"

namespace {

namespace problems = vbar::fsw::gnss::problems;
using problems::Matrix;
using problems::Random;
using problems::Vector;
using vbar::fsw::gnss::Decorrelation;

constexpr std::array<Eigen::Index, 12> kCounts{1, 2, 3, 4, 5, 6, 8, 10, 12, 16, 20, 24};
constexpr std::array<double, 6> kFailureRates{0.002, 0.005, 0.01, 0.02, 0.05, 0.1};
constexpr double kAccepted = 0.001;
constexpr int kModels = 12;
constexpr std::size_t kDraws = 100'000;

double bootstrap_failure_rate(const Matrix& covariance) {
  Decorrelation problem;
  const Vector zero = Vector::Zero(covariance.rows());
  const vbar::fsw::Status status = problem.compute({zero.data(), static_cast<std::size_t>(zero.size())},
                                                   {covariance.data(), static_cast<std::size_t>(covariance.size())});
  return status == vbar::fsw::Status::kOk ? 1.0 - vbar::fsw::gnss::bootstrap_success_rate(problem.d()) : NAN;
}

/// The covariance times the factor that gives it the failure rate.
Matrix scaled_to(const Matrix& covariance, double failure_rate) {
  double low = 1e-9;
  double high = 1e9;
  for (int i = 0; i < 100; ++i) {
    const double middle = std::sqrt(low * high);
    (bootstrap_failure_rate(middle * covariance) < failure_rate ? low : high) = middle;
  }
  return low * covariance;
}

/// The smallest ratio that keeps the part of the problems with wrong and accepted integers within kAccepted.
double sufficient_ratio(const Matrix& covariance, Random& random) {
  const Eigen::LLT<Matrix> factor(covariance);
  std::vector<double> wrong;
  for (std::size_t draw = 0; draw < kDraws; ++draw) {
    const Vector a = factor.matrixL() * problems::standard_normal(random, covariance.rows());
    const auto solution =
        vbar::fsw::gnss::resolve_ambiguities({a.data(), static_cast<std::size_t>(a.size())},
                                             {covariance.data(), static_cast<std::size_t>(covariance.size())});
    if (!solution.ok()) continue;  // not accepted either
    const auto& best = solution.value().best;
    const bool right = std::all_of(best.begin(), best.end(), [](double z) { return z == 0.0; });
    if (!right) wrong.push_back(solution.value().second_norm2 / solution.value().best_norm2);
  }
  std::sort(wrong.begin(), wrong.end(), std::greater<>());
  const auto allowed = static_cast<std::size_t>(kAccepted * kDraws);
  return wrong.size() <= allowed ? 1.0 : wrong[allowed];
}

Matrix model(Eigen::Index n, int number, Random& random) {
  if (number % 2 == 1) return problems::random_covariance(n, problems::uniform(random, 0.0, 3.0), 1.0, random);
  const Matrix whole = problems::random_session_covariance(std::max<Eigen::Index>(n, 4), random);
  return whole.topLeftCorner(n, n);
}

}  // namespace

int main() {
  std::array<std::array<double, kFailureRates.size()>, kCounts.size()> table{};
  for (std::size_t row = kCounts.size(); row-- > 0;) {
    for (std::size_t column = 0; column < kFailureRates.size(); ++column) {
      Random random(100 * row + column);
      vbar::accuracy::Largest ratio(row + 1 < kCounts.size() ? table[row + 1][column] : 1.0);
      if (column > 0) ratio.add(table[row][column - 1]);
      for (int number = 0; number < kModels; ++number) {
        const Matrix covariance = scaled_to(model(kCounts[row], number, random), kFailureRates[column]);
        ratio.add(sufficient_ratio(covariance, random));
      }
      table[row][column] = std::ceil(100.0 * ratio) / 100.0;
    }
    std::fprintf(stderr, "%td ambiguities done\n", kCounts[row]);
  }
  for (std::size_t row = 0; row < kCounts.size(); ++row) {
    std::printf("    {{");
    for (std::size_t column = 0; column < kFailureRates.size(); ++column) {
      std::printf("%s%.2f", column == 0 ? "" : ", ", table[row][column]);
    }
    std::printf("}},  // %td\n", kCounts[row]);
  }
  return 0;
}
