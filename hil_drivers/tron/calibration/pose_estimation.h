#pragma once
// The pose of the board by one image (perspective n-point), its covariance and the weight of the image.

#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "hil_drivers/tron/calibration/calibration_data.h"
#include "hil_drivers/tron/geometry/board_design.h"
#include "hil_drivers/tron/geometry/calibration.h"

namespace vbar::tron::calibrate {

// Scatter of a source's poses about its model: rotations of what carries camera and target, and their places.

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

inline constexpr double kCornerSigma_px = 0.3;  ///< an axis, of a good image
inline constexpr int kMinCorners = 8;

struct BoardPose {
  Eigen::Isometry3d T_C_B = Eigen::Isometry3d::Identity();
  /// Covariance of [rotation, rad; translation, m] in camera axes: R_true = exp(error) R, t_true = t + error.
  Matrix6 covariance = Matrix6::Identity();
  double rms_px = 0.0;    ///< root mean square of the residuals, an axis, weighted as the fit
  double sigma_px = 0.0;  ///< standard deviation of a corner of this image: rms_px, at least kCornerSigma_px
};

/// Refines the pose by Gauss-Newton with Huber's weights from `start`; null with fewer than kMinCorners corners or
/// where it does not converge.
[[nodiscard]] std::optional<BoardPose> refine_board_pose(const BoardDesign& board, const LensCalibration& lens,
                                                         const std::vector<Corner>& corners,
                                                         const Eigen::Isometry3d& start);

/// Returns the best of the poses found from `start` and from its mirror image with the tilt reversed, the other minimum
/// of a plane.
[[nodiscard]] std::optional<BoardPose> board_pose(const BoardDesign& board, const LensCalibration& lens,
                                                  const std::vector<Corner>& corners, const Eigen::Isometry3d& start);

}  // namespace vbar::tron::calibrate
