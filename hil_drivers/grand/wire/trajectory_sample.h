#pragma once
// Motion of one antenna at one instant, as an RF generator receives it: position with three derivatives and attitude
// with two, all of the same curve.

#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"

namespace vbar::grand {

/// Trajectory sample. Position and derivatives are those of the antenna's true phase centre, in the Earth-fixed frame
/// (WGS-84 axes); an observer in that rotating frame sees these derivatives.
struct TrajectorySample {
  fsw::Duration time;  ///< since the generator's start time, >= 0
  fsw::Vector3 position_ecef_m = fsw::Vector3::Zero();
  fsw::Vector3 velocity_ecef_mps = fsw::Vector3::Zero();
  fsw::Vector3 acceleration_ecef_mps2 = fsw::Vector3::Zero();
  fsw::Vector3 jerk_ecef_mps3 = fsw::Vector3::Zero();
  /// Yaw, pitch, roll (rad) of the antenna frame against the local north-east-down frame (geodetic, WGS 84), rotation
  /// order z, y, x. The antenna frame has -z along the boresight, so that an antenna that points to the zenith has zero
  /// pitch and roll. Rate and acceleration are those against the same local frame: derivatives of this attitude.
  fsw::Vector3 yaw_pitch_roll = fsw::Vector3::Zero();
  fsw::Vector3 angular_rate = fsw::Vector3::Zero();          ///< rate of the antenna frame about its own axes, rad/s
  fsw::Vector3 angular_acceleration = fsw::Vector3::Zero();  ///< rad/s^2
};

}  // namespace vbar::grand
