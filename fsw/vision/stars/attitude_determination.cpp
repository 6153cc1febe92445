#include "fsw/vision/stars/attitude_determination.h"

#include <Eigen/Geometry>

#include "fsw/math/math.h"
#include "fsw/math/symmetric_eigen.h"

namespace vbar::fsw::stars {
namespace {

using Matrix4 = Eigen::Matrix<double, 4, 4>;
using Vector4 = Eigen::Matrix<double, 4, 1>;

/// Davenport's matrix of the attitude profile B = sum a_i b_i r_i'.
Matrix4 davenport(const Matrix3& b) {
  Matrix4 k;
  k.topLeftCorner<3, 3>() = b + b.transpose() - b.trace() * Matrix3::Identity();
  const Vector3 z(b(1, 2) - b(2, 1), b(2, 0) - b(0, 2), b(0, 1) - b(1, 0));
  k.topRightCorner<3, 1>() = z;
  k.bottomLeftCorner<1, 3>() = z.transpose();
  k(3, 3) = b.trace();
  return k;
}

Matrix3 cross(const Vector3& v) {
  Matrix3 m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

/// Passive rotation of a quaternion with the scalar last (Wertz 1978, eq. 12-13b).
Matrix3 rotation(const Vector4& q) {
  const Vector3 v = q.head<3>();
  return (q(3) * q(3) - v.squaredNorm()) * Matrix3::Identity() + 2.0 * v * v.transpose() - 2.0 * q(3) * cross(v);
}

double squared_residual(const DirectionPair& pair, const Matrix3& R_camera_eci) {
  return (pair.camera - R_camera_eci * pair.eci).squaredNorm() / (pair.sigma * pair.sigma);
}

template <class T>
void swap_values(T& a, T& b) {
  const T old = a;
  a = b;
  b = old;
}

}  // namespace

double chi_square_limit(int degrees) {
  constexpr double kNormal = 3.719;  // exceeded once in 10,000
  const double a = 2.0 / (9.0 * degrees);
  const double root = 1.0 - a + kNormal * math::sqrt(a);
  return degrees * root * root * root;
}

Result<AttitudeEstimate> determine_attitude(std::span<const DirectionPair> pairs) {
  if (pairs.size() < 2) return Status::kInvalidArgument;
  Matrix3 profile = Matrix3::Zero();
  Matrix3 information = Matrix3::Zero();
  double total = 0.0;
  for (const DirectionPair& pair : pairs) {
    if (!math::is_finite(pair.camera.sum() + pair.eci.sum() + pair.sigma)) return Status::kNotFinite;
    if (!(pair.sigma > 0.0)) return Status::kInvalidArgument;
    const double weight = 1.0 / (pair.sigma * pair.sigma);
    profile += weight * pair.camera * pair.eci.transpose();
    information += weight * (Matrix3::Identity() - pair.camera * pair.camera.transpose());
    total += weight;
  }
  // Two directions less than 1e-5 rad apart leave the rotation about them open.
  constexpr double kSmallest = 1e-10;
  const double determinant = information.col(0).dot(information.col(1).cross(information.col(2)));
  if (!(determinant > kSmallest * total * total * total)) return Status::kSingular;
  const Result<math::SymmetricEigen<4>> eigen = math::symmetric_eigen<4>(davenport(profile / total));
  if (!eigen.ok()) return eigen.status();

  AttitudeEstimate estimate;
  estimate.R_camera_eci = rotation(eigen.value().vectors.col(3));
  const Matrix3 cofactors = (Matrix3() << information.col(1).cross(information.col(2)).transpose(),
                             information.col(2).cross(information.col(0)).transpose(),
                             information.col(0).cross(information.col(1)).transpose())
                                .finished();
  estimate.covariance_camera = cofactors / determinant;
  for (const DirectionPair& pair : pairs) estimate.chi_square += squared_residual(pair, estimate.R_camera_eci);
  estimate.degrees_of_freedom = 2 * static_cast<int>(pairs.size()) - 3;
  return estimate;
}

Result<RobustAttitude> determine_attitude_robustly(std::span<DirectionPair> pairs, std::span<int> tags) {
  if (tags.size() != pairs.size()) return Status::kInvalidArgument;
  const std::size_t max_dropped = pairs.size() / 3;
  for (std::size_t dropped = 0; dropped <= max_dropped; ++dropped) {
    const std::size_t count = pairs.size() - dropped;
    const Result<AttitudeEstimate> found = determine_attitude(pairs.first(count));
    if (!found.ok()) return found.status();
    const AttitudeEstimate& estimate = found.value();
    if (estimate.chi_square <= chi_square_limit(estimate.degrees_of_freedom)) {
      return RobustAttitude{estimate, static_cast<int>(count)};
    }
    if (count <= 3) break;
    std::size_t worst = 0;
    for (std::size_t k = 1; k < count; ++k) {
      if (squared_residual(pairs[k], estimate.R_camera_eci) > squared_residual(pairs[worst], estimate.R_camera_eci)) {
        worst = k;
      }
    }
    swap_values(pairs[worst], pairs[count - 1]);
    swap_values(tags[worst], tags[count - 1]);
  }
  return Status::kDidNotConverge;
}

}  // namespace vbar::fsw::stars
