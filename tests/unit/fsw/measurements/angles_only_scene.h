#pragma once
// A servicer with a target behind it, and noise to draw: what the tests of angles-only navigation share.

#include <cmath>
#include <random>

#include "fsw/filter/propagation.h"
#include "fsw/orbit/earth_rotation.h"
#include "fsw/orbit/roe.h"
#include "fsw/vision/target_tracking/bearing.h"

namespace vbar::fsw::measurements::test {

inline constexpr double kArcsec = M_PI / 180.0 / 3600.0;
inline constexpr double kA = 7087300.0;

inline GpsTime scene_start() {
  return GpsTime{} + duration_of_seconds(994'986'015);  // 2011-07-18 01:00:00 UTC
}

inline orbit::EarthOrientation scene_earth() {
  return {.epoch = scene_start(), .ut1_minus_gps_s = -15.3, .ut1_rate = 0.0, .pole_x = 0.0, .pole_y = 0.0};
}

/// Abeam of the orbit: always in the light.
inline Vector3 scene_sun() {
  return Vector3(0.45, -0.88, -0.1).normalized();
}

inline orbit::CartesianState scene_servicer() {
  const double degree = M_PI / 180.0;
  return orbit::cartesian_from_qns({kA, 0.0015, 0.0, 98.18 * degree, 207.0 * degree, -0.69 * degree}).value();
}

/// Osculating ROE from a * ROE in metres.
inline Vector6 roe_of_metres(double da, double dl, double dex, double dey, double dix, double diy) {
  return (Vector6() << da, dl, dex, dey, dix, diy).finished() / kA;
}

inline orbit::CartesianState scene_target(const orbit::CartesianState& servicer, const Vector6& roe) {
  return target_from_roe(orbit::qns_from_cartesian(servicer).value(), roe).value();
}

/// What a point target shows, with noise (rad, each axis).
inline target_tracking::BearingMeasurement bearing_of(GpsTime time, const orbit::CartesianState& servicer,
                                                      const orbit::CartesianState& target, double sigma,
                                                      const Vector2& error) {
  target_tracking::BearingMeasurement bearing;
  bearing.time = time;
  const Vector3 direction = (target.position_eci - servicer.position_eci).normalized();
  bearing.direction_eci =
      (direction + target_tracking::bearing_axes(direction, servicer).topRows<2>().transpose() * error).normalized();
  bearing.sigma = sigma;
  return bearing;
}

class Noise {
 public:
  explicit Noise(unsigned seed) : random_(seed) {}
  double normal() { return standard_(random_); }
  Vector2 normal2() {
    const double first = normal();
    return {first, normal()};
  }
  Vector6 normal6() {
    Vector6 result;
    for (int k = 0; k < 6; ++k) result(k) = normal();
    return result;
  }

 private:
  std::mt19937 random_;
  std::normal_distribution<double> standard_;
};

}  // namespace vbar::fsw::measurements::test
