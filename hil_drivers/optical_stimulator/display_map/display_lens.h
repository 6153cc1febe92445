#pragma once
// Lens part of the display map, templated on the scalar: the map evaluates it with double, the fit with dual
// numbers.

#include <array>
#include <cmath>
#include <cstddef>

namespace vbar::optical_stimulator {

/// Converts a direction to a display pixel by OpenCV's model: rotation about the boresight, Brown-Conrady distortion,
/// tilt of the display, scale and centre.
struct LensTerms {
  static constexpr std::size_t kCount = 11;

  std::array<double, 2> centre_px{959.5, 599.5};  ///< where the lens axis meets the display
  double scale_px = 6000.0;                       ///< display pixels per unit of the tangent
  double rotation_rad = 0.0;                      ///< rotation of the display about the boresight
  std::array<double, 2> tilt_rad{};               ///< tilt of the display about its x and y axes; OpenCV's tau_x, tau_y
  std::array<double, 5> distortion{};             ///< k1, k2, p1, p2, k3

  [[nodiscard]] std::array<double, kCount> values() const;
  [[nodiscard]] static LensTerms of(const std::array<double, kCount>& values);
};

/// Returns the display pixel of the tangent-plane point (x, y) = (direction x, y)/z; `terms` in the order of
/// LensTerms::values().
template <typename T>
std::array<T, 2> lens_pixel(const T* terms, const T& plane_x, const T& plane_y) {
  using std::cos;
  using std::sin;
  const T c = cos(terms[3]), s = sin(terms[3]);
  const T x = c * plane_x - s * plane_y, y = s * plane_x + c * plane_y;
  const T &k1 = terms[6], &k2 = terms[7], &p1 = terms[8], &p2 = terms[9], &k3 = terms[10];
  const T r2 = x * x + y * y;
  const T radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
  const T xd = x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x);
  const T yd = y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y;
  // Rotation about x by tau_x, then about y by tau_y, then projection along z onto the tilted plane (Louhichi et al.
  // 2007).
  const T cx = cos(terms[4]), sx = sin(terms[4]), cy = cos(terms[5]), sy = sin(terms[5]);
  const T u = cy * xd + sy * sx * yd - sy * cx, v = cx * yd + sx, w = sy * xd - cy * sx * yd + cy * cx;
  const T r22 = cy * cx, r02 = -sy * cx, r12 = sx;
  return {terms[2] * (r22 * u - r02 * w) / w + terms[0], terms[2] * (r22 * v - r12 * w) / w + terms[1]};
}

}  // namespace vbar::optical_stimulator
