#pragma once
// Ranges of the values of telecommands. A NaN is in none.

namespace vbar::fsw::sources {

inline constexpr double kLongestExposure_s = 3600.0;

constexpr bool is_between(double x, double minimum, double maximum) {
  return x >= minimum && x <= maximum;
}

/// Positive, up to the maximum.
constexpr bool is_positive(double x, double maximum) {
  return x > 0.0 && x <= maximum;
}

}  // namespace vbar::fsw::sources
