#include "fsw/vision/imaging/camera_model.h"

#include "fsw/math/math.h"

namespace vbar::fsw::imaging {
namespace {

constexpr int kMaxIterations = 20;
/// Convergence limit in the normalised image plane, 1e-6 px for any practical lens; Newton's next step would be its
/// square.
constexpr double kSmallestStep = 1e-12;
/// Half a field of 84 degrees: directions further off are not in front of the camera.
constexpr double kMinCosine = 0.1;

struct Distorted {
  Vector2 point;
  Matrix2 derivative;
};

/// Brown (1966) in OpenCV's order of coefficients, and its derivative by the undistorted point.
Distorted distort(const std::array<double, 5>& coefficients, const Vector2& p) {
  const auto [k1, k2, p1, p2, k3] = coefficients;
  const double x = p.x();
  const double y = p.y();
  const double r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
  const double slope = 2.0 * (k1 + r2 * (2.0 * k2 + r2 * 3.0 * k3));  // d(radial)/dx / x = d(radial)/dy / y
  Distorted d;
  d.point = {x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
             y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y};
  const double cross = slope * x * y + 2.0 * p1 * x + 2.0 * p2 * y;
  d.derivative << radial + slope * x * x + 2.0 * p1 * y + 6.0 * p2 * x, cross,  //
      cross, radial + slope * y * y + 6.0 * p1 * y + 2.0 * p2 * x;
  return d;
}

bool is_usable(const CameraModel& camera) {
  return camera.focal_length_px.x() > 0.0 && camera.focal_length_px.y() > 0.0;
}

}  // namespace

Result<Vector3> direction_of(const CameraModel& camera, const Vector2& pixel) {
  if (!is_usable(camera)) return Status::kInvalidArgument;
  const Vector2 seen = (pixel - camera.principal_point_px).cwiseQuotient(camera.focal_length_px);
  if (!math::is_finite(seen.x()) || !math::is_finite(seen.y())) return Status::kNotFinite;
  Vector2 p = seen;
  for (int k = 0; k < kMaxIterations; ++k) {
    const Distorted d = distort(camera.distortion, p);
    const Matrix2& J = d.derivative;
    const double determinant = J(0, 0) * J(1, 1) - J(0, 1) * J(1, 0);
    // If the determinant is not positive the image is folded over, which is outside the field of any lens.
    if (!(determinant > 0.0)) return Status::kDidNotConverge;
    const Vector2 miss = seen - d.point;
    const Vector2 step{(J(1, 1) * miss.x() - J(0, 1) * miss.y()) / determinant,
                       (J(0, 0) * miss.y() - J(1, 0) * miss.x()) / determinant};
    p += step;
    if (step.cwiseAbs().maxCoeff() < kSmallestStep) {
      const double norm = math::sqrt(1.0 + p.squaredNorm());
      return Vector3(p.x() / norm, p.y() / norm, 1.0 / norm);
    }
  }
  return Status::kDidNotConverge;
}

Result<Vector2> pixel_of(const CameraModel& camera, const Vector3& direction_camera) {
  if (!is_usable(camera)) return Status::kInvalidArgument;
  const double norm = math::sqrt(direction_camera.squaredNorm());
  if (!math::is_finite(norm)) return Status::kNotFinite;
  if (!(direction_camera.z() > kMinCosine * norm)) return Status::kOutOfRange;
  const Vector2 p = direction_camera.head<2>() / direction_camera.z();
  const Vector2 seen = distort(camera.distortion, p).point;
  return Vector2(camera.principal_point_px + seen.cwiseProduct(camera.focal_length_px));
}

Result<Projection> project(const CameraModel& camera, const Vector3& point_camera_m) {
  const Result<Vector2> pixel = pixel_of(camera, point_camera_m);
  if (!pixel.ok()) return pixel.status();
  const Vector2 p = point_camera_m.head<2>() / point_camera_m.z();
  const Matrix2 bent = distort(camera.distortion, p).derivative / point_camera_m.z();
  Projection seen;
  seen.pixel = pixel.value();
  seen.derivative.leftCols<2>() = camera.focal_length_px.asDiagonal() * bent;
  seen.derivative.col(2) = -(seen.derivative.leftCols<2>() * p);
  return seen;
}

}  // namespace vbar::fsw::imaging
