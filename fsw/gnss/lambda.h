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

// Decorrelation of float ambiguities: their covariance is factored as Q = L' D L, L unit lower triangular, and integer
// transformations z = Z' a with integer Z and |det Z| = 1 bring D into increasing order from the last element to the
// first, as far as possible. The result is a nearly diagonal problem whose last component is the most precise.
// mLAMBDA (Chang, Yang, Zhou 2005): factorisation with symmetric pivoting; integer Gauss transforms only where an
// exchange follows (the "partial" reduction of Xie, Chang, Al Borno 2011: the others change neither D nor the search).

/// Returns the nearest integer, halves to the even one, for |x| < 2^51: adding 1.5 * 2^52 leaves no bits for a
/// fraction.
inline double nearest_integer(double x) {
  constexpr double kNoFraction = 6755399441055744.0;
  return (x + kNoFraction) - kNoFraction;
}

/// A lower triangle stored by rows, without gaps, for sequential access by factorisation, exchange and search.
class LowerTriangle {
 public:
  [[nodiscard]] double* row(std::size_t i) { return &elements_[i * (i + 1) / 2]; }
  [[nodiscard]] const double* row(std::size_t i) const { return &elements_[i * (i + 1) / 2]; }

 private:
  std::array<double, kMaxAmbiguities*(kMaxAmbiguities + 1) / 2> elements_{};
};

/// Float ambiguity problem and its decorrelated form. Component k of the decorrelated form has variance d[k] when the
/// components after it are known.
class Decorrelation {
 public:
  /// Factors and reduces. `ambiguities` in cycles, `covariance` in cycles^2, n x n, of which the lower triangle of the
  /// column-major matrix is read. kInvalidArgument for sizes that do not fit; kNotFinite; kOutOfRange for |a| >= 2^51;
  /// kSingular if a conditional variance is below 1e-12 of its variance (dominated by rounding) or the correlations
  /// need transformations beyond integers of 31 bits; kDidNotConverge at the bound of the reduction. After an error the
  /// object must not be used.
  [[nodiscard]] Status compute(std::span<const double> ambiguities, std::span<const double> covariance);

  [[nodiscard]] std::size_t count() const { return count_; }
  /// Conditional variances of the decorrelated ambiguities, cycles^2.
  [[nodiscard]] std::span<const double> d() const { return std::span(d_).first(count_); }
  /// Decorrelated float ambiguities, less integers.
  [[nodiscard]] std::span<const double> z() const { return std::span(z_).first(count_); }
  /// Unit factor L; its diagonal is 1.
  [[nodiscard]] const LowerTriangle& l() const { return l_; }

  /// Transforms integer decorrelated ambiguities, in place, to those of the caller. kOutOfRange beyond 2^52.
  [[nodiscard]] Status to_original(std::span<double> z) const;

 private:
  [[nodiscard]] Status load(std::span<const double> ambiguities, std::span<const double> covariance);
  [[nodiscard]] Status factorise();
  void bring_to(std::size_t from, std::size_t to);
  [[nodiscard]] Status reduce();
  [[nodiscard]] Status subtract(std::size_t first, std::size_t second, double factor);
  void exchange(std::size_t k, double new_d);
  [[nodiscard]] double* back_column(std::size_t k) { return &back_[column_[k] * count_]; }
  [[nodiscard]] const double* back_column(std::size_t k) const { return &back_[column_[k] * count_]; }
  [[nodiscard]] Status check_magnitudes();

  std::size_t count_ = 0;
  LowerTriangle l_;
  std::array<double, kMaxAmbiguities> d_{};
  std::array<double, kMaxAmbiguities> z_{};
  std::array<double, kMaxAmbiguities> whole_{};  ///< integers subtracted from the float ambiguities
  /// Z^-T, integers: the caller's ambiguities are the sum of z[k] times column column_[k], whole_ added.
  std::array<double, kMaxAmbiguities * kMaxAmbiguities> back_{};
  std::array<std::uint8_t, kMaxAmbiguities> column_{};
  double largest_back_ = 0.0;  ///< largest element of back_
};

// The two integer vectors nearest to decorrelated float ambiguities: depth-first search in a shrinking ellipsoid, the
// candidates of a component in the order of their distance (Schnorr and Euchner 1994; Chang, Yang, Zhou 2005, 3.2).

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
