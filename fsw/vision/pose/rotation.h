#pragma once
// Small rotations and the rotation nearest to a matrix.

#include "fsw/core/result.h"
#include "fsw/core/types.h"
#include "fsw/math/math.h"
#include "fsw/math/symmetric_eigen.h"

namespace vbar::fsw::pose {

inline Matrix3 cross_matrix(const Vector3& v) {
  Matrix3 m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

/// Returns exp([rotation]x), the active rotation about `rotation` by its length, rad (Rodrigues).
inline Matrix3 rotation_by(const Vector3& rotation) {
  const double square = rotation.squaredNorm();
  const double angle = math::sqrt(square);
  double along = 1.0 - square / 6.0;    // sin(a) / a
  double across = 0.5 - square / 24.0;  // (1 - cos(a)) / a^2
  if (angle > 1e-4) {
    const double half = math::sin(0.5 * angle);
    along = math::sin(angle) / angle;
    across = 2.0 * half * half / square;
  }
  const Matrix3 k = cross_matrix(rotation);
  return Matrix3::Identity() + along * k + across * k * k;
}

/// Returns the angle of the rotation between the two, rad, to rounding of its square.
inline double angle_between(const Matrix3& a, const Matrix3& b) {
  const double chord = 0.125 * (a - b).squaredNorm();  // sin^2 of half the angle
  return 2.0 * math::asin(chord < 1.0 ? math::sqrt(chord) : 1.0);
}

/// Returns the rotation nearest to `m` in the sum of squared elements (Davenport's q-method, Wertz 1978, 12.2.2).
inline Result<Matrix3> nearest_rotation(const Matrix3& m) {
  Eigen::Matrix<double, 4, 4> k;
  k.topLeftCorner<3, 3>() = m + m.transpose() - m.trace() * Matrix3::Identity();
  const Vector3 z(m(2, 1) - m(1, 2), m(0, 2) - m(2, 0), m(1, 0) - m(0, 1));
  k.topRightCorner<3, 1>() = z;
  k.bottomLeftCorner<1, 3>() = z.transpose();
  k(3, 3) = m.trace();
  const Result<math::SymmetricEigen<4>> eigen = math::symmetric_eigen<4>(k);
  if (!eigen.ok()) return eigen.status();
  const Vector3 v = eigen.value().vectors.col(3).head<3>();
  const double w = eigen.value().vectors(3, 3);
  return Matrix3((w * w - v.squaredNorm()) * Matrix3::Identity() + 2.0 * v * v.transpose() + 2.0 * w * cross_matrix(v));
}

}  // namespace vbar::fsw::pose
