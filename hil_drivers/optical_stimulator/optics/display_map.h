#pragma once
// Map from a direction to the display pixel that sends light to the camera from there. It takes the place of the lens
// when a scene is rendered for the display.

#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "fsw/core/types.h"
#include "host_sim/twins/camera/optics.h"

namespace vbar::optical_stimulator {

// Smooth vector field on a rectangle of the display: the part of the testbed's geometry that no lens model represents.

/// Sums products T_i(u) T_j(v) of Chebyshev polynomials with i + j <= degree, one sum for each axis; u and v run
/// from -1 to 1 over the domain. Outside the domain the field has the value of the nearest point of its edge:
/// polynomials diverge where no dot was measured.
struct ChebyshevField {
  static constexpr int kDegreeMax = 16;

  int degree = -1;                ///< -1: no field
  fsw::Vector2 low_px{0.0, 0.0};  ///< domain, display pixels
  fsw::Vector2 high_px{1.0, 1.0};
  std::vector<double> x_px, y_px;  ///< coefficients in the order of chebyshev_terms()

  [[nodiscard]] static std::size_t term_count(int degree) {
    return degree < 0 ? 0 : static_cast<std::size_t>((degree + 1) * (degree + 2) / 2);
  }
};

/// Holds values of the products at a display point and their derivatives by its coordinates, 1/px.
struct ChebyshevTerms {
  std::vector<double> value, by_x, by_y;
};

/// Returns the terms in the order (0,0), (1,0), (0,1), (2,0), (1,1), (0,2), ...: by i + j, then by j.
[[nodiscard]] ChebyshevTerms chebyshev_terms(const ChebyshevField& field, const fsw::Vector2& pixel);

struct FieldValue {
  fsw::Vector2 offset_px = fsw::Vector2::Zero();
  fsw::Matrix2 jacobian = fsw::Matrix2::Zero();  ///< derivative of the offset by the display point
};

[[nodiscard]] FieldValue value_of(const ChebyshevField& field, const fsw::Vector2& pixel);

// Lens part of the display map, templated on the scalar: the map evaluates it with double, the fit with dual
// numbers.

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

/// Holds the motion of the display since calibration: a rotation and a scale about the display's middle, then a shift.
struct DayCorrection {
  fsw::Vector2 shift_px = fsw::Vector2::Zero();  ///< display pixels
  double rotation_rad = 0.0;
  double scale = 1.0;
};

struct DisplayMapParameters {
  int width_px = 1920, height_px = 1200;  ///< size of the display
  LensTerms lens;
  ChebyshevField field;  ///< added to what the lens terms give
};

/// Maps directions that the camera's own model (twins::camera::Optics of the camera file) assigns to its pixels.
/// Light from the display pixel project(direction) arrives at the camera pixel where that model places `direction`.
class DisplayMap final : public twins::camera::Projection {
 public:
  explicit DisplayMap(const DisplayMapParameters& parameters, const DayCorrection& correction = {});

  /// Returns nothing if the direction is more than 70 deg off the boresight. Beyond the display's corners the
  /// distortion continues in proportion to the angle's tangent: its polynomial would fold distant directions back onto
  /// the display.
  [[nodiscard]] std::optional<fsw::Vector2> project(const fsw::Vector3& direction_camera) const override;
  [[nodiscard]] fsw::Vector2 image_velocity(const fsw::Vector3& direction_camera,
                                            const fsw::Vector3& rate_camera) const override;
  /// Inverts by Newton's method; to 1e-9 px on the display.
  [[nodiscard]] fsw::Vector3 direction_of(const fsw::Vector2& pixel) const override;
  /// Returns 1 everywhere: the light that a display pixel causes in the camera is in the calibration's uniformity.
  [[nodiscard]] double vignetting(const fsw::Vector2& pixel) const override;
  [[nodiscard]] double focal_length_px() const override { return focal_length_px_; }

  [[nodiscard]] const DisplayMapParameters& parameters() const { return parameters_; }

 private:
  struct Point {
    fsw::Vector2 pixel;
    fsw::Matrix2 jacobian;  ///< by the tangent-plane point
  };
  [[nodiscard]] Point lens_point(const fsw::Vector2& plane) const;
  [[nodiscard]] Point point_of(const fsw::Vector2& plane) const;
  [[nodiscard]] fsw::Vector2 plane_of(const fsw::Vector2& pixel) const;
  [[nodiscard]] double corner_radius() const;

  DisplayMapParameters parameters_;
  std::array<double, LensTerms::kCount> lens_;
  fsw::Vector2 middle_px_, shift_px_;
  fsw::Matrix2 correction_;
  double radius_limit_;  ///< limit in the tangent plane: distortion is a polynomial inside
  double focal_length_px_;
};

}  // namespace vbar::optical_stimulator
