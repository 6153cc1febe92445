#pragma once
// Scatter of a source's poses about its model: rotations of what carries camera and target, and their places.

#include <vector>

#include "hil_drivers/tron/calibration_file/calibration.h"

namespace vbar::tron::calibrate {

/// Holds standard deviations an axis. A rotation of the camera moves the target at the side of the image, one of the
/// target does not: so depth, sides and rotations have covariances of their own.
struct Scatter {
  double camera_rad = 0.0, target_rad = 0.0;
  double place_m = 0.0;  ///< standard deviation of each of both places
};

/// Returns the covariance of the error [rotation, rad; translation, m] of T_C_T in camera axes.
[[nodiscard]] Matrix6 scatter_covariance(const Scatter& scatter, const Eigen::Isometry3d& T_C_T);

/// Returns [rotation; translation] in camera axes that leads from `from` to `to`: R_to = exp(rotation) R_from.
[[nodiscard]] Eigen::Matrix<double, 6, 1> pose_difference(const Eigen::Isometry3d& from, const Eigen::Isometry3d& to);

/// Holds a difference of two poses at T_C_T, and the covariance of the difference without the scatter that is
/// estimated.
struct ScatterSample {
  Eigen::Isometry3d T_C_T;
  Eigen::Matrix<double, 6, 1> difference;
  Matrix6 known_covariance;
};

/// Returns the scatter of the largest likelihood of Student's t distribution with five degrees of freedom, which an
/// outlier moves little.
[[nodiscard]] Scatter estimate_scatter(const std::vector<ScatterSample>& samples, const Scatter& start);

}  // namespace vbar::tron::calibrate
