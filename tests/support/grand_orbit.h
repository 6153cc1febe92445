#pragma once
// Analytic trajectories for the RF generator: a circular low orbit in the Earth-fixed frame with all derivatives.

#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "fsw/gnss/constants.h"
#include "hil_drivers/grand/wire/trajectory_sample.h"

namespace vbar::test {

/// The sample `t_s` after the start of an antenna on a circular orbit of 7087.3 km and 98.18 deg, boresight to the
/// zenith; `offset_ecef_m` is added to the position. The Earth-fixed frame coincides with the inertial one at 0.
inline grand::TrajectorySample sample_in_orbit(double t_s, const fsw::Vector3& offset_ecef_m = fsw::Vector3::Zero()) {
  using fsw::Matrix3;
  using fsw::Vector3;
  constexpr double kRadius_m = 7087.3e3;
  constexpr double kInclination = 98.18 * std::numbers::pi / 180.0;
  const double n = std::sqrt(fsw::gnss::kGmGps / (kRadius_m * kRadius_m * kRadius_m));
  const double c = kRadius_m * std::cos(n * t_s);
  const double s = kRadius_m * std::sin(n * t_s);
  const Vector3 node = Vector3::UnitX();
  const Vector3 ahead(0.0, std::cos(kInclination), std::sin(kInclination));
  // Derivatives in the inertial frame.
  const Vector3 f0 = c * node + s * ahead;
  const Vector3 f1 = n * (-s * node + c * ahead);
  const Vector3 f2 = -n * n * f0;
  const Vector3 f3 = -n * n * f1;
  // (d/dt)^k of R f, where dR/dt = -R W.
  Matrix3 W;
  const double rate = fsw::gnss::kEarthRateGps;
  W << 0.0, -rate, 0.0, rate, 0.0, 0.0, 0.0, 0.0, 0.0;
  const Matrix3 R = Eigen::AngleAxisd(-rate * t_s, Vector3::UnitZ()).toRotationMatrix();
  grand::TrajectorySample sample;
  sample.time = fsw::nearest_duration(t_s);
  sample.position_ecef_m = R * f0 + offset_ecef_m;
  sample.velocity_ecef_mps = R * (f1 - W * f0);
  sample.acceleration_ecef_mps2 = R * (f2 - 2.0 * W * f1 + W * W * f0);
  sample.jerk_ecef_mps3 = R * (f3 - 3.0 * W * f2 + 3.0 * W * W * f1 - W * W * W * f0);
  return sample;
}

}  // namespace vbar::test
