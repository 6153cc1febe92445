#pragma once
// Residuals of the calibration's fit as functions of its parameter blocks, with their derivatives: corners of the board
// in images, the arms against them, motion capture against the arms, and what is known before.

#include <initializer_list>
#include <memory>
#include <span>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "fsw/core/types.h"
#include "hil_drivers/tron/calibration/calibration_data.h"
#include "hil_drivers/tron/geometry/calibration.h"

namespace ceres {
class CostFunction;
}

namespace vbar::tron::calibrate {

// Places within the blocks of both arms, and sizes of the blocks.
inline constexpr int kOffset = 0, kLink = 6, kFlex = 36, kMount = 38, kCameraArm = 44, kBase = 44, kTargetArm = 50;
inline constexpr int kLens = 9, kPose = 6, kSpline = 4;

/// What the parameters are counted from.
struct ChainStart {
  Calibration calibration;
  Eigen::Isometry3d camera_mount, target_mount, target_base, V_L, C_object, object_T;
  double camera_gravity = -1.0, target_gravity = 1.0;
};

[[nodiscard]] ChainStart chain_start(const Calibration& calibration);

/// Returns the first of the four knots of the track that act at a place of the carriage.
[[nodiscard]] int first_knot_at(const TrackCalibration& track, double carriage_m);

/// Returns the pose of an image: its start, rotated and shifted by a block of six.
[[nodiscard]] Eigen::Isometry3d image_pose(const Eigen::Isometry3d& start, const double* six);

using Cost = std::unique_ptr<ceres::CostFunction>;

/// Blocks: lens, image.
[[nodiscard]] Cost corner_cost(const Eigen::Isometry3d& T_C_T, const fsw::Vector3& point_T, const fsw::Vector2& px,
                               double sigma_px);

/// Blocks: image, camera's arm, target's arm, four knots, scale. `start` outlives the cost here and below; `whiten`:
/// lower triangle of the inverse standard deviations of [rotation; translation].
[[nodiscard]] Cost arms_cost(const ChainStart& start, const Posture& posture, const Eigen::Isometry3d& T_C_T,
                             const Matrix6& whiten);

/// Blocks: V_L, camera's arm, four knots, scale, C_object.
[[nodiscard]] Cost vicon_camera_cost(const ChainStart& start, const Posture& posture,
                                     const Eigen::Isometry3d& T_V_object, const Matrix6& whiten);

/// Blocks: V_L, target's arm, object_T.
[[nodiscard]] Cost vicon_target_cost(const ChainStart& start, const Posture& posture,
                                     const Eigen::Isometry3d& T_V_object, const Matrix6& whiten);

/// Values of one block known with standard deviations.
[[nodiscard]] Cost prior_cost(std::span<const double> mean, std::span<const double> sigma);

/// Block: lens, whose focal lengths have a ratio known with a standard deviation.
[[nodiscard]] Cost aspect_cost(double ratio, double sigma);

}  // namespace vbar::tron::calibrate
