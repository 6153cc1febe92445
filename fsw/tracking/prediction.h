#pragma once
// Predicted position of the target from navigation: separates it from other objects that move like satellites.

#include "fsw/core/result.h"
#include "fsw/core/types.h"
#include "fsw/orbit/rtn.h"

namespace vbar::fsw::tracking {

using Vector5 = Eigen::Matrix<double, 5, 1>;
using Matrix5 = Eigen::Matrix<double, 5, 5>;

/// Predicted motion at an image's time: slopes (fsw/tracking/servicer_view.h), their rates and that of the distance.
/// These are all parameters of a relative orbit that bearings determine; only its scale is missing.
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

}  // namespace vbar::fsw::tracking
