#pragma once
// A bearing: the direction in which the servicer's camera observed the target, and its measurement model.

#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"
#include "fsw/orbit/elements.h"

namespace vbar::fsw::target_tracking {

/// Light time and aberration cancel for a target in formation (its velocity equals that of the camera to some metres
/// per second): the direction is that relative to star positions corrected for aberration, itself uncorrected.
struct BearingMeasurement {
  GpsTime time;                             ///< middle of the exposure
  Vector3 direction_eci = Vector3::Zero();  ///< unit vector to the centre of brightness
  double sigma = 0.0;                       ///< rad, 1 sigma, per axis across it; attitude error included
  Vector3 origin_eci = Vector3::Zero();     ///< position of the camera from the servicer's centre of mass, m
  double apparent_radius = 0.0;             ///< rad, of the target's disk; 0: a point
};

/// Rows: two unit vectors across `direction` (unit), the first in the plane of the servicer's orbit, the second nearest
/// its normal, then the direction itself. For a target ahead or behind the first is (up to its sign) the vertical.
Matrix3 bearing_axes(const Vector3& direction_eci, const orbit::CartesianState& servicer);

/// Direction to the centre of brightness: displaced to the illuminated side by `offset_m` times the component of the
/// Sun direction across the line of sight.
Vector3 centre_of_brightness(const Vector3& target_eci, const Vector3& camera_eci, const Vector3& sun_eci,
                             double offset_m);

}  // namespace vbar::fsw::target_tracking
