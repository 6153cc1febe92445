#pragma once
// Digests of the elementary functions over 20,000 arguments each. The functions come in as a table, so that the same
// sweeps can be run over another library.

#include "tests/unit/fsw/same_bits/digest.h"

namespace vbar::same_bits {

using Unary = double (*)(double);
using Binary = double (*)(double, double);

inline constexpr int kSweep = 20000;

/// Over arguments of any magnitude from 2^low to 2^high.
inline std::uint64_t sweep_magnitudes(Unary f, int low, int high) {
  Arguments arguments(1);
  Digest digest;
  for (int k = 0; k < kSweep; ++k) digest.add(f(arguments.magnitude(low, high)));
  return digest.value();
}

inline std::uint64_t sweep_interval(Unary f, double low, double high) {
  Arguments arguments(2);
  Digest digest;
  for (int k = 0; k < kSweep; ++k) digest.add(f(arguments.between(low, high)));
  return digest.value();
}

inline std::uint64_t sweep_box(Binary f, double x_low, double x_high, double y_low, double y_high) {
  Arguments arguments(3);
  Digest digest;
  for (int k = 0; k < kSweep; ++k) {
    const double x = arguments.between(x_low, x_high);
    digest.add(f(x, arguments.between(y_low, y_high)));
  }
  return digest.value();
}

}  // namespace vbar::same_bits
