#pragma once
// Predicted position of the target from navigation: separates it from other objects that move like satellites.

#include "fsw/core/result.h"
#include "fsw/core/types.h"
#include "fsw/orbit/rtn.h"

namespace vbar::fsw::tracking {

using Vector4 = Eigen::Matrix<double, 4, 1>;
using Matrix4 = Eigen::Matrix<double, 4, 4>;

/// Slopes (fsw/tracking/servicer_view.h) and their rates, at an image's time.
struct Prediction {
  Vector4 slopes = Vector4::Zero();         ///< y, z, their rates (1/s)
  Matrix4 covariance = Matrix4::Zero();     ///< of these
  double along_track_m = 0.0;               ///< T component of the target's position, negative behind; 0: unknown
  double along_track_rate = 0.0;            ///< m/s
  double along_track_sigma_fraction = 1.0;  ///< 1 sigma of along_track_m as a part of it
};

/// From the relative state in the servicer's RTN and its 6x6 covariance (position m, velocity m/s, stacked), of a
/// filter or an orbit of two-line-element quality. kNotFinite; kOutOfRange if the target is predicted more than 60
/// degrees from the T axis, or a variance is negative.
Result<Prediction> prediction_of(const orbit::RelativeState& target, const Matrix6& covariance);

/// From a bearing alone: `covariance` (rad^2) in the directions of growing R and N; rates are unknown.
/// `along_track_m` may be 0. Errors as above.
Result<Prediction> prediction_of(const Vector3& direction_rtn, const Matrix2& covariance, double along_track_m);

}  // namespace vbar::fsw::tracking
