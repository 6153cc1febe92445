#include "fsw/gnss/ambiguity_validation.h"

#include <algorithm>

#include "fsw/gnss/chi_square.h"
#include "fsw/gnss/integer_search.h"
#include "fsw/gnss/ratio_threshold.h"
#include "fsw/math/math.h"

namespace vbar::fsw::gnss {
namespace {

/// A float whose conditional variance is below this part of its variance depends on those taken before, to rounding.
/// Ten times what Decorrelation asks for, so that a set made here is one that it takes.
constexpr double kDependent = 1e-11;

constexpr double kLargestRatio = 1e9;

/// The caller's covariance.
struct Covariance {
  std::span<const double> elements;
  std::size_t size;
  [[nodiscard]] double operator()(std::size_t i, std::size_t j) const {
    return i >= j ? elements[i + j * size] : elements[j + i * size];
  }
};

/// The ambiguities being tried.
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
      !within(criteria.min_ratio, 1.0, kLargestRatio) || !within(criteria.residual_false_alarm, 0.0, 1.0) ||
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

/// Up to kMaxAmbiguities, each the sharpest given those taken before: the pivots of a Cholesky factorisation, smallest
/// first. Leaves out what depends on the others.
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
/// definite matrix. It ranks candidates only: what is held is decided on the decorrelated problem.
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

/// Takes candidate `i` out: the information of the others with it unknown is the Schur complement.
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

/// The one that stays least known when all others are: without it the dilution of precision of the rest is least, for
/// det Q without i = det Q (Q^-1)_ii. Of those that `matters` says.
template <class Matters>
std::size_t least_known(std::size_t count, ValidationWorkspace& workspace, const Matters& matters) {
  std::size_t worst = count;
  for (std::size_t i = 0; i < count; ++i) {
    if (!matters(i)) continue;
    if (worst == count || information_at(workspace, i, i) < information_at(workspace, worst, worst)) worst = i;
  }
  return worst == count ? 0 : worst;
}

/// The one whose freedom takes most off the residual: (Q^-1 (a - z))_i^2 / (Q^-1)_ii, the square of Baarda's w-test.
std::size_t least_fitting(std::size_t count, const IntegerSolution& solution, ValidationWorkspace& workspace) {
  std::size_t worst = 0;
  double largest = -1.0;
  for (std::size_t i = 0; i < count; ++i) {
    double pull = 0.0;
    for (std::size_t j = 0; j < count; ++j) {
      pull += information_at(workspace, i, j) * (workspace.floats[j] - solution.best[j]);
    }
    const double gain = pull * pull / information_at(workspace, i, i);
    if (gain > largest) {
      largest = gain;
      worst = i;
    }
  }
  return worst;
}

/// What a set of candidates came to, and the candidate to leave out if it was not accepted.
struct Trial {
  Obstacle obstacle = Obstacle::kNone;
  std::size_t worst = 0;
  IntegerSolution solution;
};

Trial try_candidates(std::span<const double> ambiguities, const Covariance& covariance, const Candidates& candidates,
                     const ValidationCriteria& criteria, ValidationWorkspace& workspace, AmbiguityDecision& decision) {
  const std::size_t n = candidates.count;
  for (std::size_t j = 0; j < n; ++j) {
    workspace.floats[j] = ambiguities[candidates.position[j]];
    for (std::size_t i = j; i < n; ++i) {
      workspace.covariance[i + j * n] = covariance(candidates.position[i], candidates.position[j]);
    }
  }
  Trial trial;
  trial.worst = least_known(n, workspace, [](std::size_t) { return true; });
  decision.success_rate = 0.0;
  decision.ratio = 0.0;
  decision.residual = 0.0;
  trial.obstacle = Obstacle::kSearch;
  const Status decorrelated = workspace.decorrelation.compute(std::span(workspace.floats).first(n),
                                                              std::span(workspace.covariance).first(n * n));
  if (decorrelated != Status::kOk) return trial;
  decision.success_rate = bootstrap_success_rate(workspace.decorrelation.d());
  // Before the search: on a weak model it would take long.
  trial.obstacle = Obstacle::kWeak;
  if (decision.success_rate < criteria.min_success_rate) return trial;
  trial.obstacle = Obstacle::kSearch;
  const Result<IntegerSolution> solution = resolve_decorrelated(workspace.decorrelation);
  if (!solution.ok()) return trial;
  trial.solution = solution.value();
  decision.residual = trial.solution.best_norm2;
  decision.ratio = std::min(trial.solution.second_norm2 / std::max(decision.residual, 1e-300), kLargestRatio);
  const double threshold = std::max(criteria.min_ratio, ratio_threshold(n, 1.0 - decision.success_rate));
  if (chi_square_tail(decision.residual, n) < criteria.residual_false_alarm) {
    trial.obstacle = Obstacle::kNoFit;
    trial.worst = least_fitting(n, trial.solution, workspace);
  } else if (decision.ratio < threshold) {
    trial.obstacle = Obstacle::kNotApart;
    trial.worst = least_known(n, workspace,
                              [&trial](std::size_t i) { return trial.solution.best[i] != trial.solution.second[i]; });
  } else {
    trial.obstacle = Obstacle::kNone;
  }
  return trial;
}

}  // namespace

Result<AmbiguityDecision> decide_ambiguities(std::span<const double> ambiguities, std::span<const double> covariance,
                                             const ValidationCriteria& criteria, ValidationWorkspace& workspace) {
  if (const Status status = check(ambiguities, covariance, criteria); status != Status::kOk) return status;
  const Covariance all{.elements = covariance, .size = ambiguities.size()};
  AmbiguityDecision decision;
  Candidates candidates = select_sharpest(all, workspace);
  if (candidates.count < std::min(all.size, kMaxAmbiguities)) decision.obstacle = Obstacle::kSearch;
  compute_information(all, candidates, workspace);
  const auto meet = [&decision](Obstacle obstacle) {
    if (decision.obstacle == Obstacle::kNone) decision.obstacle = obstacle;
  };
  while (candidates.count >= criteria.min_count) {
    ++decision.tried;
    const Trial trial = try_candidates(ambiguities, all, candidates, criteria, workspace, decision);
    if (trial.obstacle == Obstacle::kNone) {
      decision.count = candidates.count;
      decision.position = candidates.position;
      std::copy_n(trial.solution.best.begin(), candidates.count, decision.whole.begin());
      return decision;
    }
    meet(trial.obstacle);
    leave_out(trial.worst, candidates, workspace);
  }
  meet(Obstacle::kTooFew);
  return decision;
}

}  // namespace vbar::fsw::gnss
