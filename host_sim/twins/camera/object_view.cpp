#include "host_sim/twins/camera/object_view.h"

#include <cmath>

#include <Eigen/Geometry>

namespace vbar::twins::camera {
namespace {

using fsw::Vector3;

void render(const ObjectView& view, double radius_m, double albedo, int points_across, std::vector<LightSample>& out) {
  const double distance = view.position_camera.norm();
  if (!(distance > radius_m)) return;
  const Vector3 direction = view.position_camera / distance;
  const Vector3 side = direction.unitOrthogonal();
  const Vector3 other = direction.cross(side);
  // Rays of a square grid over the visible disc.
  const double reach = radius_m / std::sqrt(distance * distance - radius_m * radius_m);  // tangent of its radius
  const double pitch = 2.0 * reach / points_across;
  for (int row = 0; row < points_across; ++row) {
    for (int column = 0; column < points_across; ++column) {
      const double x = (column + 0.5) * pitch - reach, y = (row + 0.5) * pitch - reach;
      const Vector3 ray = (direction + x * side + y * other).normalized();
      const double nearest = ray.dot(view.position_camera);
      const double chord2 = radius_m * radius_m - (distance * distance - nearest * nearest);
      if (chord2 <= 0.0) continue;
      const Vector3 normal = ((nearest - std::sqrt(chord2)) * ray - view.position_camera) / radius_m;
      const double to_sun = normal.dot(view.sun_direction_camera);
      if (to_sun <= 0.0) continue;
      const double cosine = ray.dot(direction);
      const double solid_angle = pitch * pitch * cosine * cosine * cosine;
      out.push_back({ray, view.sun_photons_per_m2_s * to_sun * albedo / M_PI * solid_angle});
    }
  }
}

}  // namespace

ObjectRenderer lambert_sphere(double radius_m, double albedo, int points_across) {
  return [=](const ObjectView& view, std::vector<LightSample>& out) {
    render(view, radius_m, albedo, points_across, out);
  };
}

}  // namespace vbar::twins::camera
