#include "host_sim/truth/forces/relativity_force.h"

#include <cmath>

#include <Eigen/Geometry>

#include "host_sim/truth/earth/sun_moon.h"
#include "host_sim/truth/forces/third_body_force.h"

namespace vbar::truth {
namespace {

constexpr double kC2 = 299792458.0 * 299792458.0;  // speed of light, squared, m^2/s^2
constexpr double kEarthSpin = 9.8e8;  // the Earth's angular momentum per mass, m^2/s: IERS Conventions 2010, ch. 10

/// The Earth's orbital angular momentum per mass about the Sun, m^2/s, in GCRF: Kepler's sqrt(GM a (1 - e^2)) with a =
/// 1 au and e = 0.0167, along the pole of the ecliptic of J2000 (obliquity 84381.406", IAU 2006). It replaces the cross
/// product of distance and velocity, which the Moon perturbs by 4e-4.
fsw::Vector3 earth_orbital_angular_momentum() {
  constexpr double kEccentricity = 0.0167;
  constexpr double kObliquity = 84381.406 / 3600.0 * 3.14159265358979323846 / 180.0;
  return std::sqrt(kSunGm * kAstronomicalUnit * (1.0 - kEccentricity * kEccentricity)) *
         fsw::Vector3(0.0, -std::sin(kObliquity), std::cos(kObliquity));
}

}  // namespace

fsw::Vector3 schwarzschild_acceleration(double gm, const fsw::Vector3& position_eci, const fsw::Vector3& velocity_eci) {
  const double r = position_eci.norm();
  return gm / (kC2 * r * r * r) *
         ((4.0 * gm / r - velocity_eci.squaredNorm()) * position_eci +
          4.0 * position_eci.dot(velocity_eci) * velocity_eci);
}

fsw::Vector3 lense_thirring_acceleration(double gm, const fsw::Vector3& spin_axis_eci, const fsw::Vector3& position_eci,
                                         const fsw::Vector3& velocity_eci) {
  const double r = position_eci.norm();
  const fsw::Vector3 spin = kEarthSpin * spin_axis_eci;
  return 2.0 * gm / (kC2 * r * r * r) *
         (3.0 / (r * r) * position_eci.dot(spin) * position_eci.cross(velocity_eci) + velocity_eci.cross(spin));
}

fsw::Vector3 de_sitter_acceleration(double sun_distance, const fsw::Vector3& velocity_eci) {
  // The Conventions' V x (-GM R / (c^2 R^3)), R and V the Earth's position and velocity about the Sun, is
  // GM (R x V) / (c^2 R^3).
  static const fsw::Vector3 angular_momentum = earth_orbital_angular_momentum();
  const double factor = 3.0 * kSunGm / (kC2 * sun_distance * sun_distance * sun_distance);
  return factor * angular_momentum.cross(velocity_eci);
}

fsw::Vector3 RelativityForce::acceleration_eci(const ForceInput& input) {
  const fsw::Vector3 spin_axis_eci = input.R_itrf_gcrf.row(2).transpose();
  return schwarzschild_acceleration(gm_, input.position_eci, input.velocity_eci) +
         lense_thirring_acceleration(gm_, spin_axis_eci, input.position_eci, input.velocity_eci) +
         de_sitter_acceleration(input.sun_eci.norm(), input.velocity_eci);
}

}  // namespace vbar::truth
