#include "fsw/gnss/lambda.h"

#include "fsw/gnss/decorrelation.h"
#include "fsw/gnss/integer_search.h"
#include "fsw/math/math.h"

namespace vbar::fsw::gnss {

double bootstrap_success_rate(std::span<const double> conditional_variances) {
  double rate = 1.0;
  // 2 Phi(1 / (2 sigma)) - 1 = erf(1 / sqrt(8 sigma^2)).
  for (const double variance : conditional_variances) rate *= math::erf(math::sqrt(0.125 / variance));
  return rate;
}

double adop(std::span<const double> conditional_variances) {
  double log_determinant = 0.0;  // the determinant itself can underflow or overflow
  for (const double variance : conditional_variances) log_determinant += math::log(variance);
  return math::exp(0.5 * log_determinant / static_cast<double>(conditional_variances.size()));
}

Result<IntegerSolution> resolve_decorrelated(const Decorrelation& problem) {
  NearestIntegers nearest;
  if (const Status status = search_integers(problem, {}, nearest); status != Status::kOk) return status;
  if (nearest.found < 2) return Status::kOutOfRange;
  const std::size_t n = problem.count();
  if (const Status status = problem.to_original(std::span(nearest.best).first(n)); status != Status::kOk) return status;
  if (const Status status = problem.to_original(std::span(nearest.second).first(n)); status != Status::kOk) {
    return status;
  }
  return IntegerSolution{.count = n,
                         .best = nearest.best,
                         .second = nearest.second,
                         .best_norm2 = nearest.best_norm2,
                         .second_norm2 = nearest.second_norm2,
                         .success_rate = bootstrap_success_rate(problem.d())};
}

Result<IntegerSolution> resolve_ambiguities(std::span<const double> ambiguities, std::span<const double> covariance) {
  Decorrelation problem;
  if (const Status status = problem.compute(ambiguities, covariance); status != Status::kOk) return status;
  return resolve_decorrelated(problem);
}

}  // namespace vbar::fsw::gnss
