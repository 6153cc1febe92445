#include "hil_drivers/tron/calibration/chain_costs.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/Dense>
#include <ceres/ceres.h>

namespace vbar::tron::calibrate {
namespace {

using Eigen::Isometry3d;

template <typename T>
using Vector6 = Eigen::Matrix<T, 6, 1>;

template <typename T>
Rigid<T> cast(const Isometry3d& pose) {
  return pose.cast<T>();
}

/// Carriage, camera's arm and mount.
struct CameraChain {
  const ChainStart* start;
  Joints joints_rad;
  double carriage_m;
  int first_knot;  ///< first of the four that act here

  CameraChain(const ChainStart& s, const Posture& posture)
      : start(&s),
        joints_rad(posture.camera_rad),
        carriage_m(posture.carriage_m),
        first_knot(first_knot_at(s.calibration.track, posture.carriage_m)) {}

  template <typename T>
  Rigid<T> T_L_C(const T* arm, const T* const* knots, const T* scale) const {
    // The four control points as a track of one cell.
    TrackGrid cell = start->calibration.track.grid;
    cell.first_m += first_knot * cell.step_m;
    T four[kSpline * kTrackErrors];
    for (std::size_t k = 0; k < kSpline; ++k)
      for (std::size_t e = 0; e < kTrackErrors; ++e) four[k * kTrackErrors + e] = knots[k][e];
    const ArmCalibration& design = start->calibration.camera_arm;
    return T_L_carriage<T>(cell, carriage_m, four, kSpline, *scale) * cast<T>(design.base.isometry()) *
           T_base_flange<T>(design.lengths, joints_rad.data(), start->camera_gravity,
                            {arm + kOffset, arm + kLink, arm + kFlex}) *
           cast<T>(start->camera_mount) * rigid_of(arm + kMount);
  }
};

struct TargetChain {
  const ChainStart* start;
  Joints joints_rad;

  template <typename T>
  Rigid<T> T_L_T(const T* arm) const {
    return cast<T>(start->target_base) * rigid_of(arm + kBase) *
           T_base_flange<T>(start->calibration.target_arm.lengths, joints_rad.data(), start->target_gravity,
                            {arm + kOffset, arm + kLink, arm + kFlex}) *
           cast<T>(start->target_mount) * rigid_of(arm + kMount);
  }
};

/// [rotation; translation] in the axes of `from`'s left frame; the rotation as sine about the axis.
template <typename T>
Vector6<T> difference_of(const Rigid<T>& from, const Rigid<T>& to) {
  const Eigen::Matrix<T, 3, 3> turn = to.linear() * from.linear().transpose();
  Vector6<T> difference;
  difference << T(0.5) * (turn(2, 1) - turn(1, 2)), T(0.5) * (turn(0, 2) - turn(2, 0)),
      T(0.5) * (turn(1, 0) - turn(0, 1)), to.translation() - from.translation();
  return difference;
}

template <typename T>
Rigid<T> moved_image(const Isometry3d& start, const T* six) {
  Rigid<T> pose = cast<T>(start);
  const Rigid<T> moved = rigid_of(six);
  pose.linear() = (moved.linear() * pose.linear()).eval();
  pose.translation() += moved.translation();
  return pose;
}

template <typename T>
void write_residual(const Matrix6& whiten, const Vector6<T>& difference, T* residual) {
  Eigen::Map<Vector6<T>> out(residual);
  for (int row = 0; row < 6; ++row) {
    T sum = T(0.0);
    for (int k = 0; k <= row; ++k) sum += whiten(row, k) * difference[k];
    out[row] = sum;
  }
}

struct CornerCost {
  Isometry3d start;
  fsw::Vector3 point_T;
  fsw::Vector2 px;
  double sigma_px;

  template <typename T>
  bool operator()(const T* lens, const T* image, T* residual) const {
    const Eigen::Matrix<T, 3, 1> point = moved_image(start, image) * Eigen::Matrix<T, 3, 1>(point_T.cast<T>());
    if (!(point.z() > T(0.01))) return false;
    const auto seen = project_point<T>({lens[0], lens[1], lens[2], lens[3]}, lens + 4, point);
    residual[0] = (seen.x() - px.x()) / sigma_px;
    residual[1] = (seen.y() - px.y()) / sigma_px;
    return true;
  }
};

struct ArmsCost {
  Isometry3d start;
  CameraChain camera;
  TargetChain target;
  Matrix6 whiten;

  template <typename T>
  bool operator()(const T* const* blocks, T* residual) const {
    const Rigid<T> T_C_T = camera.T_L_C<T>(blocks[1], blocks + 3, blocks[7]).inverse() * target.T_L_T<T>(blocks[2]);
    write_residual<T>(whiten, difference_of<T>(moved_image(start, blocks[0]), T_C_T), residual);
    return true;
  }
};

struct ViconCameraCost {
  CameraChain camera;
  Isometry3d T_V_object;
  Matrix6 whiten;

  template <typename T>
  bool operator()(const T* const* blocks, T* residual) const {
    const Rigid<T> model = cast<T>(camera.start->V_L) * rigid_of(blocks[0]) *
                           camera.T_L_C<T>(blocks[1], blocks + 2, blocks[6]) * cast<T>(camera.start->C_object) *
                           rigid_of(blocks[7]);
    write_residual<T>(whiten, difference_of<T>(cast<T>(T_V_object), model), residual);
    return true;
  }
};

struct ViconTargetCost {
  TargetChain target;
  Isometry3d T_V_object;
  Matrix6 whiten;

  /// T_V_object T_object_T against T_V_L T_L_T: both of the target's frame.
  template <typename T>
  bool operator()(const T* const* blocks, T* residual) const {
    const Rigid<T> T_object_T = cast<T>(target.start->object_T) * rigid_of(blocks[2]);
    const Rigid<T> model =
        cast<T>(target.start->V_L) * rigid_of(blocks[0]) * target.T_L_T<T>(blocks[1]) * T_object_T.inverse();
    write_residual<T>(whiten, difference_of<T>(cast<T>(T_V_object), model), residual);
    return true;
  }
};

struct PriorCost {
  std::vector<double> mean, sigma;

  template <typename T>
  bool operator()(const T* const* blocks, T* residual) const {
    for (std::size_t k = 0; k < mean.size(); ++k) residual[k] = (blocks[0][k] - mean[k]) / sigma[k];
    return true;
  }
};

struct AspectCost {
  double ratio, sigma;

  template <typename T>
  bool operator()(const T* const* blocks, T* residual) const {
    residual[0] = (blocks[0][1] / blocks[0][0] - ratio) / sigma;
    return true;
  }
};

/// Derivatives in passes of one width for all costs of the chain: each width that is compiled takes half a minute.
template <class Function>
Cost derived(Function function, int residuals, std::initializer_list<int> blocks) {
  constexpr int kWidth = 16;
  auto cost = std::make_unique<ceres::DynamicAutoDiffCostFunction<Function, kWidth>>(new Function(std::move(function)));
  for (const int size : blocks) cost->AddParameterBlock(size);
  cost->SetNumResiduals(residuals);
  return cost;
}

}  // namespace

ChainStart chain_start(const Calibration& c) {
  ChainStart start{c,
                   c.camera_arm.mount.isometry(),
                   c.target_arm.mount.isometry(),
                   c.target_arm.base.isometry(),
                   c.vicon.T_V_L.isometry(),
                   c.vicon.T_C_object.isometry(),
                   c.vicon.T_object_T.isometry()};
  start.camera_gravity = c.camera_arm.base.isometry().linear()(2, 2) >= 0.0 ? 1.0 : -1.0;
  start.target_gravity = start.target_base.linear()(2, 2) >= 0.0 ? 1.0 : -1.0;
  return start;
}

int first_knot_at(const TrackCalibration& track, double carriage_m) {
  const auto count = static_cast<double>(track.knots.size());
  const double cell = std::floor((carriage_m - track.grid.first_m) / track.grid.step_m);
  return static_cast<int>(std::clamp(cell, 1.0, count - 3.0)) - 1;
}

Isometry3d image_pose(const Isometry3d& start, const double* six) {
  return moved_image(start, six);
}

Cost corner_cost(const Isometry3d& T_C_T, const fsw::Vector3& point_T, const fsw::Vector2& px, double sigma_px) {
  return std::make_unique<ceres::AutoDiffCostFunction<CornerCost, 2, kLens, kPose>>(
      new CornerCost{T_C_T, point_T, px, sigma_px});
}

Cost arms_cost(const ChainStart& start, const Posture& posture, const Isometry3d& T_C_T, const Matrix6& whiten) {
  return derived(ArmsCost{T_C_T, {start, posture}, {&start, posture.target_rad}, whiten}, 6,
                 {kPose, kCameraArm, kTargetArm, kTrackErrors, kTrackErrors, kTrackErrors, kTrackErrors, 1});
}

Cost vicon_camera_cost(const ChainStart& start, const Posture& posture, const Isometry3d& T_V_object,
                       const Matrix6& whiten) {
  return derived(ViconCameraCost{{start, posture}, T_V_object, whiten}, 6,
                 {kPose, kCameraArm, kTrackErrors, kTrackErrors, kTrackErrors, kTrackErrors, 1, kPose});
}

Cost vicon_target_cost(const ChainStart& start, const Posture& posture, const Isometry3d& T_V_object,
                       const Matrix6& whiten) {
  return derived(ViconTargetCost{{&start, posture.target_rad}, T_V_object, whiten}, 6, {kPose, kTargetArm, kPose});
}

Cost prior_cost(std::span<const double> mean, std::span<const double> sigma) {
  const int size = static_cast<int>(mean.size());
  return derived(PriorCost{{mean.begin(), mean.end()}, {sigma.begin(), sigma.end()}}, size, {size});
}

Cost aspect_cost(double ratio, double sigma) {
  return derived(AspectCost{ratio, sigma}, 1, {kLens});
}

}  // namespace vbar::tron::calibrate
