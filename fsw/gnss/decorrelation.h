#pragma once
// Decorrelation of float ambiguities: their covariance is factored as Q = L' D L, L unit lower triangular, and integer
// transformations z = Z' a with integer Z and |det Z| = 1 bring D into increasing order from the last element to the
// first, as far as possible. The result is a nearly diagonal problem whose last component is the most precise.
// mLAMBDA (Chang, Yang, Zhou 2005): factorisation with symmetric pivoting; integer Gauss transforms only where an
// exchange follows (the "partial" reduction of Xie, Chang, Al Borno 2011: the others change neither D nor the search).

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "fsw/core/result.h"
#include "fsw/gnss/lambda.h"

namespace vbar::fsw::gnss {

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

}  // namespace vbar::fsw::gnss
