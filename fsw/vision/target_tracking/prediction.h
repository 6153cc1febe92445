#pragma once
// Predicted position of the target from navigation: separates it from other objects that move like satellites.

#include "fsw/core/result.h"
#include "fsw/core/types.h"
#include "fsw/orbit/elements.h"
#include "fsw/orbit/rtn.h"

namespace vbar::fsw::target_tracking {

// Quantities of the servicer's orbit used by target tracking at an image.

/// Directions near the -T or +T axis are represented by two slopes, those of their R and N component against their T
/// component: y = d_R / d_T, z = d_N / d_T. Their sign does not depend on whether the target is ahead or behind.
struct ServicerView {
  double latitude = 0.0;       ///< true argument of latitude, rad
  double latitude_rate = 0.0;  ///< rad/s
  double mean_motion = 0.0;    ///< mean motion of the osculating orbit, rad/s
  /// Drift rate of a relative semi-major axis, with J2: d(dlambda)/dt = -drift_rate da, 1/s. The osculating mean motion
  /// and a drift without J2 differ from it by 0.2 % and 0.3 %.
  double drift_rate = 0.0;
  double semi_major_axis = 0.0;  ///< m, osculating
  /// Slope of the servicer's own path, v_R / v_T: the direction of a target that follows or leads on the same orbit.
  /// Eccentricity and the short-period terms of J2 move this direction by hundreds of arc seconds an orbit, whatever
  /// the range.
  double path_slope = 0.0;
  double path_slope_rate = 0.0;  ///< 1/s
  /// Relative rate of the distance to a target on the same orbit, d(v_T)/dt / v_T, 1/s.
  double path_stretch_rate = 0.0;
  /// Rate at which J2 rotates RTN about R, rad/s. Relative velocities of fsw/orbit/rtn.h exclude this rotation.
  double plane_rotation_rate = 0.0;
};

/// Returns the quantities of the servicer's osculating ECI state. Accelerations are those of point mass and J2. Errors
/// are those of orbit::qns_from_cartesian (unbound, equatorial, not finite) and orbit::mean_from_osculating.
Result<ServicerView> servicer_view(const orbit::CartesianState& servicer);

/// Returns the slopes y, z of a direction in RTN, not necessarily of unit length. kOutOfRange if it is more than 60
/// degrees from the T axis, in either direction; kNotFinite.
Result<Vector2> slopes_of(const Vector3& direction_rtn);

using Vector5 = Eigen::Matrix<double, 5, 1>;
using Matrix5 = Eigen::Matrix<double, 5, 5>;

/// Predicted motion at an image's time: slopes (fsw/vision/target_tracking/prediction.h), their rates and that of the
/// distance. These are all parameters of a relative orbit that bearings determine; only its scale is missing.
struct Prediction {
  Vector5 slopes = Vector5::Zero();         ///< y, z, their rates, rate of the T component over itself (1/s)
  Matrix5 covariance = Matrix5::Zero();     ///< covariance of `slopes`
  double along_track_m = 0.0;               ///< T component of the target's position, negative behind; 0: unknown
  double along_track_rate = 0.0;            ///< m/s
  double along_track_sigma_fraction = 1.0;  ///< 1 sigma of along_track_m over along_track_m
};

/// Returns the prediction from the relative state in the servicer's RTN and its 6x6 covariance (position m, velocity
/// m/s, stacked), of a filter or an orbit of two-line-element quality. kNotFinite; kOutOfRange if the target is
/// predicted more than 60 degrees from the T axis, or a variance is negative.
Result<Prediction> prediction_of(const orbit::RelativeState& target, const Matrix6& covariance);

/// Returns the prediction from a bearing alone: `covariance` (rad^2) in the directions of growing R and N; rates are
/// unknown. `along_track_m` may be 0. Errors are those of the other function.
Result<Prediction> prediction_of(const Vector3& direction_rtn, const Matrix2& covariance, double along_track_m);

}  // namespace vbar::fsw::target_tracking
