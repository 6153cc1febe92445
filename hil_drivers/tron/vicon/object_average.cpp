#include "hil_drivers/tron/vicon/object_average.h"

#include <cmath>

#include "fsw/core/types.h"

namespace vbar::tron::vicon {
namespace {

using fsw::Matrix3;
using fsw::Vector3;

constexpr int kIterations = 20;
constexpr double kConverged = 1e-15;  // rad

Vector3 rotation_vector(const Matrix3& rotation) {
  const Eigen::AngleAxisd turn(rotation);
  return turn.angle() * turn.axis();
}

Matrix3 rotation_by(const Vector3& vector) {
  const double angle = vector.norm();
  return angle > 0.0 ? Eigen::AngleAxisd(angle, vector / angle).toRotationMatrix() : Matrix3::Identity();
}

/// Karcher mean on SO(3): Manton (2004), "A globally convergent numerical algorithm for computing the centre of mass on
/// compact Lie groups".
Matrix3 mean_rotation(const std::vector<Eigen::Isometry3d>& poses) {
  Matrix3 mean = poses.front().linear();
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    Vector3 step = Vector3::Zero();
    for (const auto& pose : poses) step += rotation_vector(mean.transpose() * pose.linear());
    step /= static_cast<double>(poses.size());
    mean = Eigen::Quaterniond(mean * rotation_by(step)).normalized().toRotationMatrix();
    if (step.norm() < kConverged) break;
  }
  return mean;
}

}  // namespace

ObjectAverage average_of(const std::vector<Eigen::Isometry3d>& poses) {
  ObjectAverage average;
  if (poses.empty()) return average;
  const auto count = static_cast<double>(poses.size());
  Vector3 translation = Vector3::Zero();
  for (const auto& pose : poses) translation += pose.translation();
  average.state = ObjectState::kTracked;
  average.frames = static_cast<int>(poses.size());
  average.T_V_object.translation() = translation / count;
  average.T_V_object.linear() = mean_rotation(poses);
  double translation2 = 0.0, rotation2 = 0.0;
  for (const auto& pose : poses) {
    translation2 += (pose.translation() - average.T_V_object.translation()).squaredNorm();
    rotation2 += rotation_vector(average.T_V_object.linear().transpose() * pose.linear()).squaredNorm();
  }
  if (poses.size() > 1) {
    average.translation_scatter_m = std::sqrt(translation2 / (3.0 * (count - 1.0)));
    average.rotation_scatter_rad = std::sqrt(rotation2 / (3.0 * (count - 1.0)));
  }
  return average;
}

}  // namespace vbar::tron::vicon
