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

// Centroid of the light of a body of unknown attitude: the mean offset from the centre of mass, towards the Sun, and
// the scatter about it grow with the phase angle a, as less of the body is lit and farther from its middle. A Lambert
// sphere has the offset R (3 pi/16) (1 + cos a) sin a / (sin a + (pi - a) cos a) (Lindegren 1977), which R (3 pi/16)
// sqrt(1 - cos a) approximates by 10 %; bodies of flat faces follow it up to 100 deg and stay there.
//
// Monte Carlo with the renderer, of Tango (0.86 m: square root of the mean silhouette) at phase angles of 45, 90 and
// 140 deg, over 16 axes of rotation with 8 attitudes each: mean offset 7.3, 16.3 and 16.4 cm, scatter on each axis 5.7,
// 9.7 and 20 cm, and 3, 3 and 4.5 cm of its means over a rotation.

/// Cosine of the phase angle, target to Sun and target to camera; `sight` from the camera, `sun_eci` a unit vector.
double cos_phase_of(const Vector3& sight, const Vector3& sun_eci);

/// Scatter of the centroid at a phase angle over that at 90 deg.
double centroid_scatter_growth(double cos_phase);

/// Displacement of the centre of brightness across the line of sight, towards the Sun, for an offset of one metre at a
/// phase angle of 90 deg.
Vector3 brightness_displacement(const Vector3& sight, const Vector3& sun_eci);

/// Displacement of the centre of brightness across the line of sight by earthlight: the part of the unit vector towards
/// the Earth's centre. Images of Tango with the Earth's light, 70 m to 8 km, at two nodes: 1 to 2 cm towards the Earth
/// above its night side, 3 cm at a Sun 12 deg above the horizon, 5 to 7 cm at 60 deg.
Vector3 earthlight_displacement(const Vector3& sight, const Vector3& target_eci);

/// Offsets of the centre of brightness, m: towards the Sun, at a phase angle of 90 deg, and towards the Earth.
struct BrightnessOffsets {
  double to_sun_m = 0.0;
  double to_earth_m = 0.0;
};
Vector3 centre_of_brightness(const Vector3& target_eci, const Vector3& camera_eci, const Vector3& sun_eci,
                             const BrightnessOffsets& offsets);

}  // namespace vbar::fsw::target_tracking
