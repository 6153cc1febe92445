#pragma once
// The two integer vectors nearest to decorrelated float ambiguities: depth-first search in a shrinking ellipsoid, the
// candidates of a component in the order of their distance (Schnorr and Euchner 1994; Chang, Yang, Zhou 2005, 3.2).

#include <array>
#include <cstddef>

#include "fsw/core/result.h"
#include "fsw/gnss/decorrelation.h"

namespace vbar::fsw::gnss {

/// Largest number of nodes of a search. A problem whose success rate is 0.5 takes some hundred at 24 ambiguities; one
/// with this many cannot be resolved reliably. A node costs about 100 cycles of a Cortex-A9.
inline constexpr std::size_t kMaxSearchNodes = 1U << 18U;

/// Larger than any squared distance in a search.
inline constexpr double kUnboundedNorm2 = 1e300;

struct SearchLimits {
  double norm2 = kUnboundedNorm2;  ///< only vectors closer than this are searched
  std::size_t nodes = kMaxSearchNodes;
};

/// Decorrelated integers and their squared distances from the float ones in the metric of the covariance.
struct NearestIntegers {
  std::size_t found = 0;  ///< 0, 1 or 2; the squared distance of those not found is the limit
  std::array<double, kMaxAmbiguities> best{};
  std::array<double, kMaxAmbiguities> second{};
  double best_norm2 = 0.0;
  double second_norm2 = 0.0;
};

/// Searches the two nearest integer vectors. kDidNotConverge at the node limit: `nearest` then holds the nearest found
/// so far.
Status search_integers(const Decorrelation& problem, const SearchLimits& limits, NearestIntegers& nearest);

/// Solves as resolve_ambiguities() does, for a problem that is decorrelated already.
Result<IntegerSolution> resolve_decorrelated(const Decorrelation& problem);

}  // namespace vbar::fsw::gnss
