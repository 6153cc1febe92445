#pragma once
// The pose of the board by one image (perspective n-point), its covariance and the weight of the image.

#include <optional>
#include <vector>

#include "hil_drivers/tron/calibrate/board/board_design.h"
#include "hil_drivers/tron/calibrate/data/measurement.h"
#include "hil_drivers/tron/calibration_file/calibration.h"

namespace vbar::tron::calibrate {

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
