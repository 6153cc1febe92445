#pragma once
// One least-squares problem for lens, chains, track, mounts and motion capture.

#include <vector>

#include <Eigen/Core>

#include "hil_drivers/tron/calibration/calibration_data.h"
#include "hil_drivers/tron/calibration/pose_estimation.h"
#include "hil_drivers/tron/geometry/board_design.h"
#include "hil_drivers/tron/geometry/calibration.h"

namespace vbar::tron::calibrate {

/// Names the parameters of the arms that are fitted, each stage with all before it.
enum class FitStage { kLens, kMounts, kOffsets, kFlexAndTrack, kWholeChain };

struct FitImage {
  Measurement measurement;
  Eigen::Isometry3d T_C_T = Eigen::Isometry3d::Identity();  ///< by the board; where the fit starts
  double sigma_px = 0.3;                                    ///< standard deviation of its corners
};

/// Holds standard deviations of what is known before the fit.
struct FitPriors {
  double focal_ratio = 5e-3, pixel_aspect = 1e-4, centre_px = 8.0, distortion_ratio = 0.05;
  double offset_rad = 8.7e-3;                 // 0.5 deg
  double link_rad = 8.7e-4, link_m = 5e-4;    // 0.05 deg
  double flex_rad_m = 1.7e-3;                 // 0.1 deg/m
  double track_rad = 8.7e-4, track_m = 1e-3;  // 0.05 deg
  double track_scale = 3e-4;
  double mount_rad = 0.1, mount_m = 0.03;
  double base_rad = 0.02, base_m = 0.02;
  double vicon_rad = 0.3, vicon_m = 0.3;  ///< about the start
};

struct FitSettings {
  FitStage stage = FitStage::kWholeChain;
  bool is_lens_free = true;
  bool is_vicon_used = true;
  Scatter arms{2e-4, 2e-4, 2e-4}, vicon{1.6e-3, 1.6e-3, 3e-4};
  FitPriors priors;
};

struct FitResult {
  Calibration calibration;
  std::vector<Eigen::Isometry3d> T_C_T;  ///< poses of the images, by all sources together
  Eigen::MatrixXd covariance;            ///< parameters of the whole chain and motion capture, after kWholeChain only
  bool is_usable = false;
  double cost = 0.0;
  int iterations = 0;
};

/// Fits all parameters from `start`; `T_target_board` places the board. Vicon's frames in `start` have to be near their
/// answer.
[[nodiscard]] FitResult fit_chain(const BoardDesign& board, const Eigen::Isometry3d& T_target_board,
                                  const std::vector<FitImage>& images, const Calibration& start,
                                  const FitSettings& settings);

/// Returns the covariance of the arms' T_C_T at a posture by that of the parameters: [rotation, rad; translation, m] in
/// camera axes.
[[nodiscard]] Matrix6 posterior_of_arms(const FitResult& fit, const Posture& posture);

/// Returns the covariance of the difference of arms and motion capture: without what is common to both, such as a
/// rotation of the camera, which is equivalent to a shift of the lens' centre. Fusion weighs the sources by the errors
/// that they do not share. It needs a fit with motion capture.
[[nodiscard]] Matrix6 posterior_of_difference(const FitResult& fit, const Posture& posture);

}  // namespace vbar::tron::calibrate
