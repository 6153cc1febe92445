#pragma once
// A slow, independent truth for the orbit tests: point mass and J2 (optional) by small Runge-Kutta 4 steps in long
// double.

#include <array>
#include <cmath>

#include "fsw/orbit/elements.h"
#include "fsw/orbit/gravity_field.h"

namespace vbar::fsw::orbit::reference {

using Real = long double;
using Vec = std::array<Real, 3>;

inline Vec axpy(const Vec& x, Real s, const Vec& y) {
  return {x[0] + s * y[0], x[1] + s * y[1], x[2] + s * y[2]};
}

/// Gradient of mu/r [1 - J2 (Re/r)^2 P2(z/r)].
inline Vec gravity(const Vec& r, Real j2) {
  const Real r2 = r[0] * r[0] + r[1] * r[1] + r[2] * r[2];
  const Real radius = std::sqrt(r2);
  const Real central = -static_cast<Real>(kMu) / (r2 * radius);
  const Real k =
      1.5L * j2 * static_cast<Real>(kMu) * static_cast<Real>(kEarthRadius * kEarthRadius) / (r2 * r2 * radius);
  const Real z2 = 5.0L * r[2] * r[2] / r2;
  return {central * r[0] + k * r[0] * (z2 - 1.0L), central * r[1] + k * r[1] * (z2 - 1.0L),
          central * r[2] + k * r[2] * (z2 - 3.0L)};
}

/// `duration` seconds on (or back), classical Runge-Kutta 4 in steps of at most `step` s. With 2 s steps the truncation
/// error over six hours in low orbit is under 0.1 mm.
inline CartesianState fly(const CartesianState& state, double duration, double step = 2.0, double j2 = kJ2) {
  Vec r{state.position_eci(0), state.position_eci(1), state.position_eci(2)};
  Vec v{state.velocity_eci(0), state.velocity_eci(1), state.velocity_eci(2)};
  const int steps = static_cast<int>(std::ceil(std::abs(duration) / step));
  const Real h = steps > 0 ? static_cast<Real>(duration) / steps : 0.0L;
  for (int k = 0; k < steps; ++k) {
    const Vec a1 = gravity(r, j2);
    const Vec v2 = axpy(v, h / 2, a1);
    const Vec a2 = gravity(axpy(r, h / 2, v), j2);
    const Vec v3 = axpy(v, h / 2, a2);
    const Vec a3 = gravity(axpy(r, h / 2, v2), j2);
    const Vec v4 = axpy(v, h, a3);
    const Vec a4 = gravity(axpy(r, h, v3), j2);
    for (std::size_t i = 0; i < 3; ++i) {
      r[i] += h / 6 * (v[i] + 2 * v2[i] + 2 * v3[i] + v4[i]);
      v[i] += h / 6 * (a1[i] + 2 * a2[i] + 2 * a3[i] + a4[i]);
    }
  }
  CartesianState end;
  for (int i = 0; i < 3; ++i) {
    end.position_eci(i) = static_cast<double>(r[static_cast<std::size_t>(i)]);
    end.velocity_eci(i) = static_cast<double>(v[static_cast<std::size_t>(i)]);
  }
  return end;
}

}  // namespace vbar::fsw::orbit::reference
