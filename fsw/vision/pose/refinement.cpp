#include "fsw/vision/pose/refinement.h"

#include "fsw/math/cholesky.h"
#include "fsw/math/math.h"
#include "fsw/vision/pose/rotation.h"

namespace vbar::fsw::pose {
namespace {

constexpr int kMaxSteps = 25;
constexpr double kSmallestStep = 1e-9;  ///< rad, and of the distance

struct Normals {
  double cost = 0.0;
  Matrix6 weighted = Matrix6::Zero();     ///< with Huber's weights
  Matrix6 information = Matrix6::Zero();  ///< without
  Vector6 gradient = Vector6::Zero();
};

Result<Normals> normals_at(std::span<const Observation> observations, const imaging::CameraModel& camera,
                           const TargetPose& pose) {
  Normals n;
  for (const Observation& o : observations) {
    const Vector3 rotated = pose.R_camera_body * o.body;
    const Result<imaging::Projection> seen = imaging::project(camera, rotated + pose.position_camera_m);
    if (!seen.ok()) return seen.status();
    const Vector2 miss = o.whitening * (seen.value().pixel - o.pixel);
    Eigen::Matrix<double, 2, 6> J;
    const Eigen::Matrix<double, 2, 3> by_position = o.whitening * seen.value().derivative;
    J << -(by_position * cross_matrix(rotated)), by_position;
    const double length = math::sqrt(miss.squaredNorm());
    const bool is_far = length > kHuberSigmas;
    const double weight = is_far ? kHuberSigmas / length : 1.0;
    n.cost += is_far ? kHuberSigmas * (length - 0.5 * kHuberSigmas) : 0.5 * length * length;
    const Matrix6 square = J.transpose() * J;
    n.information += square;
    n.weighted += weight * square;
    n.gradient += weight * (J.transpose() * miss);
  }
  if (!math::is_finite(n.cost)) return Status::kNotFinite;
  return n;
}

TargetPose moved(const TargetPose& pose, const Vector6& step) {
  return {rotation_by(step.head<3>()) * pose.R_camera_body, pose.position_camera_m + step.tail<3>()};
}

}  // namespace

Result<Vector2> miss_of(const Observation& observation, const TargetPose& pose, const imaging::CameraModel& camera) {
  const Vector3 point = pose.R_camera_body * observation.body + pose.position_camera_m;
  const Result<Vector2> pixel = imaging::pixel_of(camera, point);
  if (!pixel.ok()) return pixel.status();
  return Vector2(pixel.value() - observation.pixel);
}

Result<RefinedPose> refine_pose(std::span<const Observation> observations, const imaging::CameraModel& camera,
                                const TargetPose& start) {
  TargetPose pose = start;
  Result<Normals> here = normals_at(observations, camera, pose);
  if (!here.ok()) return here.status();
  double damping = 0.0;  // times the diagonal
  for (int k = 0; k < kMaxSteps; ++k) {
    Matrix6 damped = here.value().weighted;
    damped.diagonal() *= 1.0 + damping;
    const math::Cholesky6 cholesky(damped);
    if (!cholesky.ok()) return Status::kSingular;
    const Vector6 step = -cholesky.solve(here.value().gradient);
    const TargetPose next = moved(pose, step);
    const double range = math::sqrt(pose.position_camera_m.squaredNorm());
    const bool is_small = step.head<3>().cwiseAbs().maxCoeff() < kSmallestStep &&
                          step.tail<3>().cwiseAbs().maxCoeff() < kSmallestStep * range;
    const Result<Normals> there = normals_at(observations, camera, next);
    if (there.ok() && (there.value().cost <= here.value().cost || is_small)) {
      pose = next;
      here = there;
      damping *= 0.1;
      if (is_small) break;
    } else {
      if (is_small) break;
      damping = damping > 1e-4 ? 10.0 * damping : 1e-3;
    }
  }
  return RefinedPose{pose, here.value().cost, here.value().information};
}

}  // namespace vbar::fsw::pose
