#include "host_sim/twins/camera/optics.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/LU>

namespace vbar::twins::camera {

using fsw::Vector2;

Cone Projection::cone_of(const Region& region, double margin_px) const {
  const double left = region.x - 0.5 - margin_px, right = region.x + region.width - 0.5 + margin_px;
  const double top = region.y - 0.5 - margin_px, bottom = region.y + region.height - 0.5 + margin_px;
  Cone cone;
  cone.axis = direction_of({0.5 * (left + right), 0.5 * (top + bottom)});
  for (const Vector2& corner :
       {Vector2(left, top), Vector2(right, top), Vector2(left, bottom), Vector2(right, bottom)}) {
    const double cosine = std::min(1.0, cone.axis.dot(direction_of(corner)));
    cone.half_angle = std::max(cone.half_angle, std::acos(cosine));
  }
  return cone;
}

using fsw::Matrix2;
using fsw::Vector3;

Optics::Optics(const CameraSettings& settings)
    : settings_(settings.optics),
      focal_length_px_(settings.focal_length_px()),
      corner_px_(0.5 * std::hypot(settings.detector.width, settings.detector.height)),
      principal_point_px_(settings.optics.principal_point_px[0], settings.optics.principal_point_px[1]) {}

Vector2 Optics::distort(const Vector2& plane) const {
  const auto& [k1, k2, p1, p2, k3] = settings_.distortion;
  const double x = plane.x(), y = plane.y(), r2 = plane.squaredNorm();
  const double radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
  return {x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
          y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y};
}

Matrix2 Optics::distortion_slope(const Vector2& plane) const {
  const auto& [k1, k2, p1, p2, k3] = settings_.distortion;
  const double x = plane.x(), y = plane.y(), r2 = plane.squaredNorm();
  const double radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
  const double growth = 2.0 * (k1 + r2 * (2.0 * k2 + 3.0 * r2 * k3));  // growth of radial, per x and per unit of x
  Matrix2 slope;
  slope(0, 0) = radial + growth * x * x + 2.0 * p1 * y + 6.0 * p2 * x;
  slope(0, 1) = growth * x * y + 2.0 * p1 * x + 2.0 * p2 * y;
  slope(1, 0) = slope(0, 1);
  slope(1, 1) = radial + growth * y * y + 6.0 * p1 * y + 2.0 * p2 * x;
  return slope;
}

std::optional<Vector2> Optics::project(const Vector3& direction_camera) const {
  constexpr double kCosine70 = 0.342;
  if (!(direction_camera.z() > kCosine70 * direction_camera.norm())) return std::nullopt;
  const Vector2 plane = direction_camera.head<2>() / direction_camera.z();
  return Vector2(focal_length_px_ * distort(plane) + principal_point_px_);
}

Vector2 Optics::image_velocity(const Vector3& direction_camera, const Vector3& rate_camera) const {
  const double z = direction_camera.z();
  const Vector2 plane = direction_camera.head<2>() / z;
  const Vector2 plane_rate = (rate_camera.head<2>() - plane * rate_camera.z()) / z;
  return focal_length_px_ * (distortion_slope(plane) * plane_rate);
}

Vector3 Optics::direction_of(const Vector2& pixel) const {
  const Vector2 wanted = (pixel - principal_point_px_) / focal_length_px_;
  Vector2 plane = wanted;
  for (int iteration = 0; iteration < 10; ++iteration) {
    const Vector2 miss = distort(plane) - wanted;
    if (miss.squaredNorm() < 1e-26) break;
    plane -= distortion_slope(plane).inverse() * miss;
  }
  return Vector3(plane.x(), plane.y(), 1.0).normalized();
}

double Optics::vignetting(const Vector2& pixel) const {
  const double ratio2 = (pixel - principal_point_px_).squaredNorm() / (corner_px_ * corner_px_);
  return std::max(0.0, 1.0 - settings_.vignetting * ratio2 * ratio2);
}

void PixelDirections::prepare(const Region& region) {
  if (!directions_.empty() && region == region_) return;
  region_ = region;
  directions_.clear();
  directions_.reserve(static_cast<std::size_t>(region.width) * static_cast<std::size_t>(region.height));
  for (int y = region.y; y < region.y + region.height; ++y)
    for (int x = region.x; x < region.x + region.width; ++x)
      directions_.push_back(projection_->direction_of(fsw::Vector2(x, y)));
}

}  // namespace vbar::twins::camera
