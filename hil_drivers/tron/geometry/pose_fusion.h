#pragma once
// Fusion of two measurements of the same relative pose, weighted by their covariances.

#include <Eigen/Geometry>

namespace vbar::tron {

/// Chi-square of 6 degrees of freedom, 95 %.
inline constexpr double kFusionGate = 12.6;

/// Holds a pose T and the covariance of its error: T_true = T exp(error), error = [rotation, rad; translation, m].
struct PoseEstimate {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Identity();
};

enum class FusionSources { kBoth, kArmsAlone };

struct FusedPose {
  PoseEstimate pose;
  double chi_square = 0.0;  ///< difference of both sources, 6 degrees of freedom
  FusionSources sources = FusionSources::kBoth;
};

/// Returns rotation vector and translation [r; t] such that the pose is exp([r; t]), the exponential of SE(3) (twist).
[[nodiscard]] Eigen::Matrix<double, 6, 1> pose_log(const Eigen::Isometry3d& pose);
[[nodiscard]] Eigen::Isometry3d pose_exp(const Eigen::Matrix<double, 6, 1>& vector);

/// Fuses by d = log(T_K^-1 T_V), S_F = (S_K^-1 + S_V^-1)^-1, T_F = T_K exp(S_F S_V^-1 d). Where d is beyond the gate,
/// or the pose of motion capture is not finite, the arms' pose is returned as it is.
[[nodiscard]] FusedPose fuse(const PoseEstimate& arms, const PoseEstimate& vicon);

}  // namespace vbar::tron
