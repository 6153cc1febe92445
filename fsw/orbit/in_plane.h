#pragma once
// Position of a spacecraft in its orbital plane, from QNS elements, without the argument of perigee: regular at e = 0.

#include "fsw/orbit/elements.h"

namespace vbar::fsw::orbit {

/// Largest eccentricity that the orbit functions accept.
inline constexpr double kMaxEccentricity = 0.95;

/// Root F = w + E of Kepler's equation in QNS form, u = F - ex sin F + ey cos F, with its sine and cosine.
struct EccentricLatitude {
  double sin = 0.0;
  double cos = 1.0;
  double angle = 0.0;  ///< rad, within e of u
};

/// Solves Kepler's equation for e = |(ex, ey)| <= kMaxEccentricity and finite u (rad). Newton's method, error under
/// 1e-15 rad for |u| < pi; kDidNotConverge after 20 iterations, kOutOfRange for a larger e, kNotFinite.
Result<EccentricLatitude> solve_kepler(double ex, double ey, double u);

/// Direction of the position in the plane, axis x to the ascending node, axis y 90 deg ahead.
struct InPlane {
  double cos_theta = 1.0;  ///< theta is the true argument of latitude, w + f
  double sin_theta = 0.0;
  double radius_over_a = 1.0;  ///< r/a
  double eta = 1.0;            ///< sqrt(1 - e^2)
};

/// Returns the position in the plane for valid elements, otherwise an error of solve_kepler.
Result<InPlane> in_plane(const QnsElements& elements);

}  // namespace vbar::fsw::orbit
