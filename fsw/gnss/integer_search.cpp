#include "fsw/gnss/integer_search.h"

#include <algorithm>

#include "fsw/math/math.h"

namespace vbar::fsw::gnss {
namespace {

/// One component of the current vector.
struct Level {
  double centre = 0.0;     ///< float value given the integers of the later components
  double whole = 0.0;      ///< current integer
  double step = 0.0;       ///< to the next candidate: 1, -2, 3, ... or -1, 2, -3, ...
  double distance2 = 0.0;  ///< squared distance of the later components
  double weight = 0.0;     ///< 1 / conditional variance
};

void enter(Level& level, double centre, double distance2) {
  level.centre = centre;
  level.whole = nearest_integer(centre);
  level.step = __builtin_copysign(1.0, centre - level.whole);
  level.distance2 = distance2;
}

void next_candidate(Level& level) {
  level.whole += level.step;
  level.step = -level.step - __builtin_copysign(1.0, level.step);
}

/// Writes the current vector to its place.
void keep(const std::array<Level, kMaxAmbiguities>& levels, std::size_t n, double norm2, NearestIntegers& nearest) {
  std::array<double, kMaxAmbiguities>* place = &nearest.second;
  if (norm2 < nearest.best_norm2) {
    nearest.second = nearest.best;
    nearest.second_norm2 = nearest.best_norm2;
    nearest.best_norm2 = norm2;
    place = &nearest.best;
  } else {
    nearest.second_norm2 = norm2;
  }
  for (std::size_t k = 0; k < n; ++k) (*place)[k] = levels[k].whole;
  nearest.found = std::min<std::size_t>(nearest.found + 1, 2);
}

}  // namespace

Status search_integers(const Decorrelation& problem, const SearchLimits& limits, NearestIntegers& nearest) {
  const std::size_t n = problem.count();
  std::array<Level, kMaxAmbiguities> levels{};
  for (std::size_t k = 0; k < n; ++k) levels[k].weight = 1.0 / problem.d()[k];
  // Row k: centres of components 0 to k given the integers of those after k.
  LowerTriangle centres;
  std::copy(problem.z().begin(), problem.z().end(), centres.row(n - 1));
  nearest.found = 0;
  nearest.best_norm2 = limits.norm2;
  nearest.second_norm2 = limits.norm2;
  std::size_t k = n - 1;
  enter(levels[k], centres.row(k)[k], 0.0);
  for (std::size_t node = 0; node < limits.nodes; ++node) {
    Level& level = levels[k];
    const double residual = level.centre - level.whole;
    const double distance2 = level.distance2 + residual * residual * level.weight;
    if (!(distance2 < nearest.second_norm2)) {
      // Further candidates are only more distant: this component is exhausted.
      if (++k == n) return Status::kOk;
      next_candidate(levels[k]);
    } else if (k > 0) {
      const double* from = centres.row(k);
      const double* correlation = problem.l().row(k);
      double* to = centres.row(k - 1);
      for (std::size_t j = 0; j < k; ++j) to[j] = from[j] - residual * correlation[j];
      --k;
      enter(levels[k], to[k], distance2);
    } else {
      keep(levels, n, distance2, nearest);
      next_candidate(level);
    }
  }
  return Status::kDidNotConverge;
}

}  // namespace vbar::fsw::gnss
