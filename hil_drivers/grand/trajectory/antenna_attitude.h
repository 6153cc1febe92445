#pragma once
// Attitude of an antenna against the local north-east-down frame (geodetic, WGS 84), as trajectory samples state it.
// The antenna frame has -z along the boresight.

#include "fsw/core/types.h"
#include "hil_drivers/grand/wire/trajectory_sample.h"

namespace vbar::grand {

/// Axes of the local frame at a position, its rotation against the Earth and the rate of change of that rotation, both
/// in its own axes (north, east, down).
struct LocalFrame {
  fsw::Matrix3 R_ned_ecef = fsw::Matrix3::Identity();
  fsw::Vector3 rate_ned = fsw::Vector3::Zero();                  ///< rad/s
  fsw::Vector3 angular_acceleration_ned = fsw::Vector3::Zero();  ///< rad/s^2
};
/// Returns the local frame of a point that moves with this velocity and acceleration in the Earth-fixed frame.
/// Undefined on the axis of the Earth.
LocalFrame local_frame(const fsw::Vector3& position_ecef_m, const fsw::Vector3& velocity_ecef_mps,
                       const fsw::Vector3& acceleration_ecef_mps2);

/// Returns the rotation from antenna axes to the axes of the local frame: R = Rz(yaw) Ry(pitch) Rx(roll).
fsw::Matrix3 R_ned_antenna(const fsw::Vector3& yaw_pitch_roll);
/// Returns the angles of a rotation; pitch from -pi/2 to pi/2.
fsw::Vector3 yaw_pitch_roll(const fsw::Matrix3& R_ned_antenna);

/// Returns the direction of the boresight of the antenna of a sample, Earth-fixed, unit vector.
fsw::Vector3 boresight_ecef(const TrajectorySample& sample);

}  // namespace vbar::grand
