#include "fsw/gnss/ambiguity_validation.h"

#include <algorithm>
#include <array>
#include <limits>

#include "fsw/gnss/lambda.h"
#include "fsw/math/math.h"

namespace vbar::fsw::gnss {

double chi_square_tail(double x, std::size_t degrees) {
  const double half = 0.5 * x;
  const bool odd = degrees % 2 == 1;
  // Terms half^s / Gamma(s + 1) exp(-half), s from 0 or 1/2 in steps of 1 while below degrees / 2.
  constexpr double kTwoOverSqrtPi = 1.12837916709551257390;
  double power = odd ? 0.5 : 0.0;
  double term = math::exp(-half) * (odd ? kTwoOverSqrtPi * math::sqrt(half) : 1.0);
  double tail = odd ? math::erfc(math::sqrt(half)) : 0.0;
  for (std::size_t k = odd ? 3 : 2; k <= degrees; k += 2) {
    tail += term;
    power += 1.0;
    term *= half / power;
  }
  return tail;
}

namespace {

// Output of tests/unit/fsw/gnss/ratio_table.cpp, which describes the method: simulated, for kFixFailureRate.
constexpr std::array<std::size_t, 12> kCounts{1, 2, 3, 4, 5, 6, 8, 10, 12, 16, 20, 24};
constexpr std::array<double, 6> kModelFailureRates{0.002, 0.005, 0.01, 0.02, 0.05, kLargestModelFailureRate};
constexpr std::array<std::array<double, kModelFailureRates.size()>, kCounts.size()> kRatios{{
    {{1.39, 2.20, 3.35, 6.31, 32.16, 602.82}},  // 1
    {{1.35, 1.86, 2.81, 4.96, 14.15, 52.87}},   // 2
    {{1.29, 1.83, 2.45, 3.54, 9.12, 17.15}},    // 3
    {{1.24, 1.72, 2.27, 3.31, 6.26, 10.27}},    // 4
    {{1.22, 1.66, 2.17, 2.78, 4.68, 7.44}},     // 5
    {{1.22, 1.62, 2.04, 2.52, 3.85, 4.75}},     // 6
    {{1.16, 1.43, 1.71, 2.21, 2.84, 3.59}},     // 8
    {{1.13, 1.36, 1.71, 1.80, 2.47, 2.88}},     // 10
    {{1.13, 1.27, 1.46, 1.64, 1.96, 2.41}},     // 12
    {{1.12, 1.24, 1.38, 1.51, 1.80, 1.86}},     // 16
    {{1.11, 1.22, 1.38, 1.45, 1.59, 1.69}},     // 20
    {{1.10, 1.21, 1.31, 1.41, 1.51, 1.59}},     // 24
}};

}  // namespace

double ratio_threshold(std::size_t count, double model_failure_rate) {
  if (count == 0 || !(model_failure_rate <= kLargestModelFailureRate)) return std::numeric_limits<double>::infinity();
  if (model_failure_rate <= kFixFailureRate) return 1.0;  // the failure rate cannot be exceeded, whatever is accepted
  // Rounded to the stricter entry: the ratio falls with the number of ambiguities and grows with the failure rate.
  std::size_t row = kCounts.size() - 1;
  while (kCounts[row] > count) --row;
  std::size_t column = 0;
  while (kModelFailureRates[column] < model_failure_rate) ++column;
  return kRatios[row][column];
}

namespace {

/// A float whose conditional variance is below this part of its variance is a linear combination of those before, to
/// rounding. Ten times the limit of Decorrelation, so that a set made here is accepted there.
constexpr double kDependent = 1e-11;

constexpr double kLargestRatio = 1e9;

/// Number of ambiguities that may be wrong at once.
constexpr std::size_t kMaxMisfits = 4;

/// The caller's covariance.
struct Covariance {
  std::span<const double> elements;
  std::size_t size;
  [[nodiscard]] double operator()(std::size_t i, std::size_t j) const {
    return i >= j ? elements[i + j * size] : elements[j + i * size];
  }
};

/// The ambiguities considered.
struct Candidates {
  std::size_t count = 0;
  std::array<std::uint8_t, kMaxAmbiguities> position{};
};

Status check(std::span<const double> ambiguities, std::span<const double> covariance,
             const ValidationCriteria& criteria) {
  const std::size_t n = ambiguities.size();
  if (n > kMaxFloatAmbiguities || covariance.size() != n * n) return Status::kInvalidArgument;
  const auto within = [](double x, double low, double high) { return x >= low && x <= high; };
  if (!within(criteria.min_success_rate, 1.0 - kLargestModelFailureRate, 1.0) ||
      !within(criteria.min_ratio, 1.0, kLargestRatio) || !within(criteria.residual_false_alarm, 1e-12, 0.5) ||
      criteria.min_count == 0) {
    return Status::kInvalidArgument;
  }
  double sum = 0.0;
  for (std::size_t j = 0; j < n; ++j) {
    sum += 0.0 * ambiguities[j];
    for (std::size_t i = j; i < n; ++i) sum += 0.0 * covariance[i + j * n];
  }
  return math::is_finite(sum) ? Status::kOk : Status::kNotFinite;
}

/// Selects up to kMaxAmbiguities, each the most precise given those before: the pivots of a Cholesky factorisation,
/// smallest first. Leaves out those that depend on the others.
Candidates select_sharpest(const Covariance& covariance, ValidationWorkspace& workspace) {
  std::array<double, kMaxFloatAmbiguities> rest{};
  std::array<bool, kMaxFloatAmbiguities> taken{};
  for (std::size_t i = 0; i < covariance.size; ++i) rest[i] = covariance(i, i);
  Candidates candidates;
  const std::size_t wanted = std::min(covariance.size, kMaxAmbiguities);
  for (std::size_t c = 0; c < wanted; ++c) {
    std::size_t sharpest = covariance.size;
    for (std::size_t i = 0; i < covariance.size; ++i) {
      if (taken[i] || !(rest[i] > kDependent * covariance(i, i))) continue;
      if (sharpest == covariance.size || rest[i] < rest[sharpest]) sharpest = i;
    }
    if (sharpest == covariance.size) break;
    taken[sharpest] = true;
    ++candidates.count;
    const double inverse_root = 1.0 / math::sqrt(rest[sharpest]);
    double* column = &workspace.factor[c * kMaxFloatAmbiguities];
    for (std::size_t i = 0; i < covariance.size; ++i) {
      if (taken[i] && i != sharpest) continue;
      double sum = covariance(i, sharpest);
      for (std::size_t b = 0; b < c; ++b) {
        const double* before = &workspace.factor[b * kMaxFloatAmbiguities];
        sum -= before[i] * before[sharpest];
      }
      column[i] = sum * inverse_root;
      if (i != sharpest) rest[i] -= column[i] * column[i];
    }
  }
  std::size_t next = 0;
  for (std::size_t i = 0; i < covariance.size; ++i) {
    if (taken[i]) candidates.position[next++] = static_cast<std::uint8_t>(i);
  }
  return candidates;
}

double& information_at(ValidationWorkspace& workspace, std::size_t i, std::size_t j) {
  return workspace.information[i + j * kMaxAmbiguities];
}

/// Inverse of the candidates' covariance, by Gauss-Jordan elimination in place, which needs no pivoting for a positive
/// definite matrix. It only ranks candidates: the decision is made on the decorrelated problem.
void compute_information(const Covariance& covariance, const Candidates& candidates, ValidationWorkspace& workspace) {
  const std::size_t n = candidates.count;
  const auto p = [&workspace](std::size_t i, std::size_t j) -> double& { return information_at(workspace, i, j); };
  for (std::size_t j = 0; j < n; ++j) {
    for (std::size_t i = 0; i < n; ++i) p(i, j) = covariance(candidates.position[i], candidates.position[j]);
  }
  for (std::size_t k = 0; k < n; ++k) {
    const double inverse = 1.0 / p(k, k);
    for (std::size_t j = 0; j < n; ++j) {
      if (j == k) continue;
      const double factor = p(k, j) * inverse;
      for (std::size_t i = 0; i < n; ++i) {
        if (i != k) p(i, j) -= p(i, k) * factor;
      }
      p(k, j) = factor;
    }
    for (std::size_t i = 0; i < n; ++i) p(i, k) *= i == k ? 0.0 : -inverse;
    p(k, k) = inverse;
  }
}

/// Removes candidate `i`: the information of the others with it unknown is the Schur complement.
void leave_out(std::size_t i, Candidates& candidates, ValidationWorkspace& workspace) {
  const std::size_t n = candidates.count;
  const auto p = [&workspace](std::size_t r, std::size_t c) -> double& { return information_at(workspace, r, c); };
  const double inverse = 1.0 / p(i, i);
  for (std::size_t c = 0; c < n; ++c) {
    if (c == i) continue;
    const double factor = p(i, c) * inverse;
    for (std::size_t r = 0; r < n; ++r) {
      if (r != i) p(r, c) -= p(r, i) * factor;
    }
  }
  for (std::size_t c = 0; c < n; ++c) {
    if (c == i) continue;
    const std::size_t to = c > i ? c - 1 : c;
    for (std::size_t r = 0; r < n; ++r) {
      if (r != i) p(r > i ? r - 1 : r, to) = p(r, c);
    }
  }
  std::copy(candidates.position.begin() + static_cast<std::ptrdiff_t>(i) + 1, candidates.position.begin() + n,
            candidates.position.begin() + static_cast<std::ptrdiff_t>(i));
  --candidates.count;
}

/// The one that stays least certain when all others are known: without it the dilution of precision is smallest, for
/// det Q without i = det Q (Q^-1)_ii. Of those selected by `matters`.
template <class Matters>
std::size_t least_certain(std::size_t count, ValidationWorkspace& workspace, const Matters& matters) {
  std::size_t worst = count;
  for (std::size_t i = 0; i < count; ++i) {
    if (!matters(i)) continue;
    if (worst == count || information_at(workspace, i, i) < information_at(workspace, worst, worst)) worst = i;
  }
  return worst == count ? 0 : worst;
}

/// Decorrelates the candidates, except the one at `without` (their count: none).
Status decorrelate(std::span<const double> ambiguities, const Covariance& covariance, const Candidates& candidates,
                   std::size_t without, ValidationWorkspace& workspace) {
  std::array<std::uint8_t, kMaxAmbiguities> position{};
  std::size_t n = 0;
  for (std::size_t i = 0; i < candidates.count; ++i) {
    if (i != without) position[n++] = candidates.position[i];
  }
  for (std::size_t j = 0; j < n; ++j) {
    workspace.floats[j] = ambiguities[position[j]];
    for (std::size_t i = j; i < n; ++i) workspace.covariance[i + j * n] = covariance(position[i], position[j]);
  }
  return workspace.decorrelation.compute(std::span(workspace.floats).first(n),
                                         std::span(workspace.covariance).first(n * n));
}

/// The one without which the others come closest to integers. The search is truncated: the vectors found first are
/// close enough to identify a fault.
std::size_t least_fitting(std::span<const double> ambiguities, const Covariance& covariance,
                          const Candidates& candidates, ValidationWorkspace& workspace) {
  constexpr std::size_t kNodes = 1000;
  std::size_t worst = 0;
  double minimum = kUnboundedNorm2;
  for (std::size_t i = 0; i < candidates.count; ++i) {
    if (decorrelate(ambiguities, covariance, candidates, i, workspace) != Status::kOk) continue;
    NearestIntegers nearest;
    (void)search_integers(workspace.decorrelation, {.norm2 = minimum, .nodes = kNodes}, nearest);
    if (nearest.found == 0) continue;
    minimum = nearest.best_norm2;
    worst = i;
  }
  return worst;
}

/// An upper bound of the chi-square quantile of the given tail probability (Laurent and Massart 2000, lemma 1).
double chi_square_reach(std::size_t degrees, double tail) {
  const double n = static_cast<double>(degrees);
  const double weight = -math::log(tail);
  return n + 2.0 * math::sqrt(n * weight) + 2.0 * weight;
}

/// Result of a set of candidates, and the candidate to leave out if it was not accepted.
struct Trial {
  RejectionReason rejection_reason = RejectionReason::kNone;
  std::size_t worst = 0;
  std::array<double, kMaxAmbiguities> whole{};
};

Trial try_candidates(std::span<const double> ambiguities, const Covariance& covariance, const Candidates& candidates,
                     const ValidationCriteria& criteria, ValidationWorkspace& workspace, AmbiguityDecision& decision) {
  const std::size_t n = candidates.count;
  Trial trial;
  trial.worst = least_certain(n, workspace, [](std::size_t) { return true; });
  trial.rejection_reason = RejectionReason::kSearch;
  decision.success_rate = 0.0;
  decision.ratio = 0.0;
  decision.residual = 0.0;
  if (decorrelate(ambiguities, covariance, candidates, n, workspace) != Status::kOk) return trial;
  const Decorrelation& problem = workspace.decorrelation;
  decision.success_rate = bootstrap_success_rate(problem.d());
  if (decision.success_rate < criteria.min_success_rate) {
    trial.rejection_reason = RejectionReason::kWeak;
    return trial;
  }
  // Within the distance of integers that fit, and without a second-best that is too close.
  const double min_ratio = std::max(criteria.min_ratio, ratio_threshold(n, 1.0 - decision.success_rate));
  const double reach = min_ratio * chi_square_reach(n, criteria.residual_false_alarm);
  NearestIntegers nearest;
  if (search_integers(problem, {.norm2 = reach}, nearest) != Status::kOk) return trial;
  decision.residual = nearest.best_norm2;
  decision.ratio = std::min(nearest.second_norm2 / std::max(nearest.best_norm2, 1e-300), kLargestRatio);
  if (nearest.found == 0 || chi_square_tail(decision.residual, n) < criteria.residual_false_alarm) {
    trial.rejection_reason = RejectionReason::kNoFit;
    trial.worst = least_fitting(ambiguities, covariance, candidates, workspace);
    return trial;
  }
  if (problem.to_original(std::span(nearest.best).first(n)) != Status::kOk) return trial;
  if (decision.ratio < min_ratio) {  // then the second-best is within reach
    if (problem.to_original(std::span(nearest.second).first(n)) != Status::kOk) return trial;
    trial.rejection_reason = RejectionReason::kNotApart;
    trial.worst =
        least_certain(n, workspace, [&nearest](std::size_t i) { return nearest.best[i] != nearest.second[i]; });
    return trial;
  }
  trial.rejection_reason = RejectionReason::kNone;
  trial.whole = nearest.best;
  return trial;
}

}  // namespace

Result<AmbiguityDecision> decide_ambiguities(std::span<const double> ambiguities, std::span<const double> covariance,
                                             const ValidationCriteria& criteria, ValidationWorkspace& workspace) {
  if (const Status status = check(ambiguities, covariance, criteria); status != Status::kOk) return status;
  const Covariance all{.elements = covariance, .size = ambiguities.size()};
  AmbiguityDecision decision;
  Candidates candidates = select_sharpest(all, workspace);
  if (candidates.count < std::min(all.size, kMaxAmbiguities)) decision.rejection_reason = RejectionReason::kSearch;
  compute_information(all, candidates, workspace);
  std::size_t misfits = 0;
  const auto meet = [&decision](RejectionReason rejection_reason) {
    if (decision.rejection_reason == RejectionReason::kNone) decision.rejection_reason = rejection_reason;
  };
  while (candidates.count >= criteria.min_count) {
    ++decision.tried;
    const Trial trial = try_candidates(ambiguities, all, candidates, criteria, workspace, decision);
    if (trial.rejection_reason == RejectionReason::kNone) {
      decision.count = candidates.count;
      decision.position = candidates.position;
      decision.whole = trial.whole;
      return decision;
    }
    meet(trial.rejection_reason);
    if (trial.rejection_reason == RejectionReason::kNoFit && ++misfits > kMaxMisfits) return decision;
    leave_out(trial.worst, candidates, workspace);
  }
  meet(RejectionReason::kTooFew);
  return decision;
}

}  // namespace vbar::fsw::gnss
