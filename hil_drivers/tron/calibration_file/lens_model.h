#pragma once
// Pinhole camera with Brown-Conrady distortion, as OpenCV orders its terms, for any scalar.

#include <array>

#include <Eigen/Core>

namespace vbar::tron {

/// Returns the pixel of a point in camera axes; `focal_centre`: fx, fy, cx, cy; `distortion`: k1, k2, p1, p2, k3.
template <typename T>
Eigen::Matrix<T, 2, 1> project_point(const std::array<T, 4>& focal_centre, const T* distortion,
                                     const Eigen::Matrix<T, 3, 1>& point) {
  const T x = point.x() / point.z(), y = point.y() / point.z();
  const T r2 = x * x + y * y;
  const T radial = T(1.0) + r2 * (distortion[0] + r2 * (distortion[1] + r2 * distortion[4]));
  const T xd = x * radial + T(2.0) * distortion[2] * x * y + distortion[3] * (r2 + T(2.0) * x * x);
  const T yd = y * radial + distortion[2] * (r2 + T(2.0) * y * y) + T(2.0) * distortion[3] * x * y;
  return {focal_centre[0] * xd + focal_centre[2], focal_centre[1] * yd + focal_centre[3]};
}

}  // namespace vbar::tron
