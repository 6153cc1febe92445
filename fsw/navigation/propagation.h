#pragma once
// Both spacecraft under the same gravity of degree 20, so that what it still leaves out hardly parts them; the target
// is pushed besides by what differs between the two.

#include "fsw/core/gps_time.h"
#include "fsw/orbit/earth_rotation.h"
#include "fsw/orbit/elements.h"

namespace vbar::fsw::navigation {

/// Differential acceleration of a spacecraft over the one it is compared with, m/s^2.
struct Push {
  double along_track = 0.0;  ///< in T of its own RTN: drag
  double from_sun = 0.0;     ///< away from the Sun, while in its light: radiation pressure
};

/// Coasts from one instant: the Earth's orientation is worked out once for all spacecraft and sigma points.
class Propagation {
 public:
  /// `sun_eci`: unit vector to the Sun, constant over a coast.
  Propagation(GpsTime start, const orbit::EarthOrientation& earth, const Vector3& sun_eci);

  /// The state `dt` seconds (either sign, at most kLongest) after the start. Classical Runge-Kutta 4, steps of at most
  /// 20 s: a quarter of a metre an orbit, and a hundredth of that between two spacecraft 75 km apart. Beyond kLongest
  /// it stops there. The caller answers for finite input.
  [[nodiscard]] orbit::CartesianState coast(const orbit::CartesianState& state, double dt, const Push& push = {}) const;

  static constexpr double kLongest = 7200.0;

 private:
  [[nodiscard]] Vector3 acceleration(const orbit::CartesianState& state, double after, const Push& push) const;

  Matrix3 R_itrf_gcrf_;  ///< at the start
  Vector3 sun_eci_;
};

/// Whether the Sun is clear of the Earth's cylinder of shadow. `position_eci` in m, `sun_eci` a unit vector.
bool is_sunlit(const Vector3& position_eci, const Vector3& sun_eci);

}  // namespace vbar::fsw::navigation
