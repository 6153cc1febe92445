#pragma once
// Integer least squares for carrier-phase ambiguities: the LAMBDA method (Teunissen 1995) in its modified form, mLAMBDA
// (Chang, Yang, Zhou 2005): factorisation with symmetric pivoting, reduction with few integer Gauss transforms, search
// after Schnorr and Euchner in a shrinking ellipsoid.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "fsw/core/result.h"

namespace vbar::fsw::gnss {

inline constexpr std::size_t kMaxAmbiguities = 24;

/// The best and second-best integer vectors, and what tells whether to believe them.
struct IntegerSolution {
  std::size_t count = 0;
  std::array<double, kMaxAmbiguities> best{};  ///< whole numbers; |.| < 2^53
  std::array<double, kMaxAmbiguities> second{};
  double best_norm2 = 0.0;  ///< (a - z)' Q^-1 (a - z)
  double second_norm2 = 0.0;
  double success_rate = 0.0;  ///< of bootstrapping on the decorrelated ambiguities: a lower bound (Teunissen 1998)
};

/// `ambiguities` (cycles, n of them, 1 <= n <= kMaxAmbiguities) and their covariance (cycles^2, n x n, column-major;
/// the lower triangle is read). kNotFinite; kSingular for a covariance that is not positive definite; kOutOfRange for
/// an ambiguity too large to be a whole number; kDidNotConverge when the search reaches its bound.
Result<IntegerSolution> resolve_ambiguities(std::span<const double> ambiguities, std::span<const double> covariance);

}  // namespace vbar::fsw::gnss
