#pragma once
// The slow way to a body's light: rays from the camera, rays to the Sun, every triangle asked. Lambert surfaces only.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>

#include "host_sim/twins/camera/model/cad_model.h"
#include "host_sim/twins/camera/model/target_renderer.h"
#include "tests/support/figures.h"

namespace vbar::twins::camera {

struct Hit {
  double distance = std::numeric_limits<double>::infinity();
  const Triangle* triangle = nullptr;
};

/// A sphere around each triangle of a model, as plain numbers: most triangles need no more to be ruled out.
class Spheres {
 public:
  explicit Spheres(const CadModel& model) {
    for (const Triangle& t : model.triangles) {
      const fsw::Vector3 middle = (t.corners[0] + t.corners[1] + t.corners[2]) / 3.0;
      accuracy::Largest square;
      for (const fsw::Vector3& corner : t.corners) square.add((corner - middle).squaredNorm());
      spheres_.push_back({middle.x(), middle.y(), middle.z(), 1.0001 * square});
    }
  }
  [[nodiscard]] bool met(std::size_t i, const fsw::Vector3& from, const fsw::Vector3& direction) const {
    const std::array<double, 4>& s = spheres_[i];
    const double x = s[0] - from[0], y = s[1] - from[1], z = s[2] - from[2];
    const double along = x * direction[0] + y * direction[1] + z * direction[2];
    return x * x + y * y + z * z - along * along <= s[3] + 1e-9;
  }

 private:
  std::vector<std::array<double, 4>> spheres_;
};

/// Nearest triangle along a ray, a unit vector. Moeller and Trumbore (1997).
inline Hit nearest_hit(const CadModel& model, const Spheres& spheres, const fsw::Vector3& from,
                       const fsw::Vector3& direction) {
  Hit hit;
  for (std::size_t i = 0; i < model.triangles.size(); ++i) {
    if (!spheres.met(i, from, direction)) continue;
    const Triangle& t = model.triangles[i];
    const fsw::Vector3 a = t.corners[1] - t.corners[0], b = t.corners[2] - t.corners[0], p = direction.cross(b);
    const double determinant = a.dot(p);
    if (std::abs(determinant) < 1e-14) continue;
    const fsw::Vector3 s = from - t.corners[0], q = s.cross(a);
    const double u = s.dot(p) / determinant, v = direction.dot(q) / determinant, d = b.dot(q) / determinant;
    if (u < 0.0 || v < 0.0 || u + v > 1.0 || d <= 1e-6 || d >= hit.distance) continue;
    hit = {d, &t};
  }
  return hit;
}

struct TracedLight {
  double flux = 0.0, flux_without_shadows = 0.0;  // photons/(m^2 s) at the lens
  fsw::Vector3 direction = fsw::Vector3::Zero();  // mean, camera axes
};

/// By this many rays, evenly strewn over the tangents of the angles from the middle of the body's sphere: Roberts's R2
/// sequence, so that no edge or grid of the body falls in with them.
inline TracedLight trace(const CadModel& model, const TargetView& view, int rays) {
  const fsw::Matrix3 R_body_camera = view.R_camera_body.transpose();
  const fsw::Vector3 camera = -R_body_camera * view.position_camera, sun = R_body_camera * view.sun_camera;
  const fsw::Vector3 axis = (model.centre - camera).normalized();
  const fsw::Vector3 x = axis.unitOrthogonal(), y = axis.cross(x);
  const double reach = std::tan(std::asin(model.radius_m / (model.centre - camera).norm()));
  const Spheres spheres(model);
  TracedLight light;
  for (int k = 0; k < rays; ++k) {
    const double u = 2.0 * std::fmod(0.5 + 0.7548776662466927 * k, 1.0) - 1.0;
    const double v = 2.0 * std::fmod(0.5 + 0.5698402909980532 * k, 1.0) - 1.0;
    const fsw::Vector3 on_plane = axis + reach * (u * x + v * y), ray = on_plane.normalized();
    const Hit hit = nearest_hit(model, spheres, camera, ray);
    if (hit.triangle == nullptr) continue;
    const auto& c = hit.triangle->corners;
    fsw::Vector3 normal = (c[1] - c[0]).cross(c[2] - c[0]).normalized();
    if (normal.dot(ray) > 0.0) normal = -normal;
    const double incidence = normal.dot(sun);
    if (incidence <= 0.0) continue;
    const double solid_angle = 4.0 * reach * reach / rays / std::pow(on_plane.norm(), 3);
    const double flux = view.sun_photons_per_m2_s * incidence * model.materials[hit.triangle->material].grey_diffuse() /
                        std::numbers::pi * solid_angle;
    light.flux_without_shadows += flux;
    const fsw::Vector3 point = camera + hit.distance * ray + 1e-5 * normal;
    if (nearest_hit(model, spheres, point, sun).triangle != nullptr) continue;
    light.flux += flux;
    light.direction += flux * (view.R_camera_body * ray);
  }
  light.direction /= light.flux;
  return light;
}

// Sums over the samples of a rendered body, and the view most tests begin with.

struct Light {
  double flux = 0.0;                              // photons/(m^2 s)
  fsw::Vector3 direction = fsw::Vector3::Zero();  // mean, weighted with flux
};

inline Light sum_of(const std::vector<LightSample>& samples) {
  Light light;
  for (const LightSample& s : samples) {
    light.flux += s.photons_per_m2_s;
    light.direction += s.photons_per_m2_s * s.direction_camera;
  }
  if (light.flux > 0.0) light.direction /= light.flux;
  return light;
}

inline constexpr double kSunPhotons = 1.3e21;  // 1/(m^2 s), of the order of the real one

/// A body on the boresight, camera and body axes parallel, the Sun at this phase angle (Sun, body, camera) towards +x.
inline TargetView view_at(double range_m, double phase) {
  TargetView view;
  view.position_camera = fsw::Vector3(0.0, 0.0, range_m);
  view.sun_camera = fsw::Vector3(std::sin(phase), 0.0, -std::cos(phase));
  view.sun_photons_per_m2_s = kSunPhotons;
  return view;
}

}  // namespace vbar::twins::camera
