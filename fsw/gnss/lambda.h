#pragma once
// Integer least squares for carrier-phase ambiguities, min (a - z)' Q^-1 (a - z) over integer z: the LAMBDA method
// (Teunissen 1995) in its modified form, mLAMBDA (Chang, Yang, Zhou 2005): factorisation with symmetric pivoting,
// reduction with few integer Gauss transforms, search after Schnorr and Euchner in a shrinking ellipsoid.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "fsw/core/result.h"

namespace vbar::fsw::gnss {

inline constexpr std::size_t kMaxAmbiguities = 24;

/// The best and second-best integer vectors, with criteria for their validation.
struct IntegerSolution {
  std::size_t count = 0;
  std::array<double, kMaxAmbiguities> best{};  ///< integers; |.| < 2^53
  std::array<double, kMaxAmbiguities> second{};
  double best_norm2 = 0.0;  ///< (a - z)' Q^-1 (a - z)
  double second_norm2 = 0.0;
  double success_rate = 0.0;  ///< lower bound by bootstrapping on the decorrelated ambiguities (Teunissen 1998)
};

/// Returns the probability that sequential rounding ("bootstrapping") of ambiguities with these conditional variances
/// (cycles^2, each given those fixed before it) yields the correct integers: prod of 2 Phi(1 / (2 sigma)) - 1
/// (Teunissen 1998, equation 18). For a decorrelated problem it is a sharp lower bound of the success rate of integer
/// least squares.
double bootstrap_success_rate(std::span<const double> conditional_variances);

/// Returns the ambiguity dilution of precision, cycles: det(Q)^(1/(2 n)), the geometric mean of the conditional
/// standard deviations in any order and after any integer transformation (Teunissen 1997).
double adop(std::span<const double> conditional_variances);

/// Resolves `ambiguities` (cycles, n of them, 1 <= n <= kMaxAmbiguities) with their covariance (cycles^2, n x n,
/// column-major; the lower triangle is read). kNotFinite; kSingular for a covariance that is not positive definite;
/// kOutOfRange for an ambiguity too large to be an integer; kDidNotConverge when the search reaches its bound.
Result<IntegerSolution> resolve_ambiguities(std::span<const double> ambiguities, std::span<const double> covariance);

}  // namespace vbar::fsw::gnss
