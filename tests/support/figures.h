#pragma once
// Accumulators for what a test measures over many cases. std::max(0.0, NaN) is 0.0, so that a kernel which returns NaN
// would pass every comparison made with it; here a NaN comes in and stays, and no comparison with it holds. The check
// tests/test_rules refuses the other forms.
//
//   accuracy::Largest largest;
//   for (...) largest.add(relative_difference(...));
//   EXPECT_LT(largest, 1e-13);

#include <algorithm>
#include <cmath>
#include <limits>
#include <ostream>
#include <vector>

#include <Eigen/Core>

namespace vbar::accuracy {

/// What `add` was given last that was not below (Largest) or above (Smallest) all before; a NaN, once it was given one.
template <int sign>
struct Extreme {
  double value;

  template <typename... Numbers>
  void add(Numbers... numbers) {
    (add_one(static_cast<double>(numbers)), ...);
  }
  operator double() const { return value; }  // NOLINT(google-explicit-constructor): compared like the number that it is

  friend std::ostream& operator<<(std::ostream& out, const Extreme& extreme) { return out << extreme.value; }

 private:
  void add_one(double number) {
    if (!std::isnan(value) && !(sign * number <= sign * value)) value = number;
  }
};

struct Largest : Extreme<1> {
  Largest() : Extreme{0.0} {}
  explicit Largest(double start) : Extreme{start} {}
};
struct Smallest : Extreme<-1> {
  Smallest() : Extreme{std::numeric_limits<double>::infinity()} {}
  explicit Smallest(double start) : Extreme{start} {}
};

/// The largest magnitude among a matrix's entries; NaN if one is NaN, which Eigen's maxCoeff() passes over.
template <typename Matrix>
[[nodiscard]] double largest_entry(const Matrix& matrix) {
  Largest largest;
  for (const double entry : matrix.reshaped()) largest.add(std::abs(entry));
  return largest;
}

/// The largest value of the smallest part of the values, `share` of their number. NaN if one of them is NaN (to sort
/// NaN is undefined) or none is given.
[[nodiscard]] inline double quantile(std::vector<double> values, double share) {
  const auto is_nan = [](double value) { return std::isnan(value); };
  if (values.empty() || std::any_of(values.begin(), values.end(), is_nan))
    return std::numeric_limits<double>::quiet_NaN();
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

/// The middle value; the mean of the middle two of an even number. NaN as above.
[[nodiscard]] inline double median(const std::vector<double>& values) {
  if (values.size() % 2 == 1) return quantile(values, 0.5);
  std::vector<double> negative;
  for (const double value : values) negative.push_back(-value);
  return 0.5 * (quantile(values, 0.5) - quantile(negative, 0.5));
}

}  // namespace vbar::accuracy
