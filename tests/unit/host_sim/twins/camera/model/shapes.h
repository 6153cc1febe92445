#pragma once
// Shapes whose light can be worked out by hand.

#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "host_sim/twins/camera/model/cad_model.h"

namespace vbar::twins::camera::shapes {

using fsw::Vector3;

inline Material lambert(double albedo) {
  return {"lambert", {albedo, albedo, albedo}, {0.0, 0.0, 0.0}, 0.0};
}

/// The parallelogram from `corner` along two sides.
inline void add_plate(std::vector<Triangle>& to, const Vector3& corner, const Vector3& a, const Vector3& b,
                      std::size_t material = 0) {
  const Vector3 n = a.cross(b).normalized();
  to.push_back({{corner, corner + a, corner + a + b}, {n, n, n}, material});
  to.push_back({{corner, corner + a + b, corner + b}, {n, n, n}, material});
}

/// A sphere about `centre`, `rings` rings of twice as many quadrangles. Its radius is a little larger than asked, so
/// that the middle cross-section of the polyhedron is that of the sphere.
inline void add_sphere(std::vector<Triangle>& to, const Vector3& centre, double radius, int rings,
                       std::size_t material = 0) {
  const double pi = std::numbers::pi;
  const double step = pi / rings;
  const double corner_radius = radius * std::sqrt(step / std::sin(step));
  const auto direction = [step](int ring, int meridian) {
    return Vector3(std::sin(ring * step) * std::cos(meridian * step), std::sin(ring * step) * std::sin(meridian * step),
                   std::cos(ring * step));
  };
  const auto add = [&](const Vector3& a, const Vector3& b, const Vector3& c) {
    to.push_back(
        {{centre + corner_radius * a, centre + corner_radius * b, centre + corner_radius * c}, {a, b, c}, material});
  };
  for (int r = 0; r < rings; ++r)
    for (int m = 0; m < 2 * rings; ++m) {
      const Vector3 a = direction(r, m), b = direction(r + 1, m), c = direction(r + 1, m + 1), d = direction(r, m + 1);
      if (r + 1 < rings) add(a, b, c);
      if (r > 0) add(a, c, d);
    }
}

inline CadModel model_of(std::vector<Triangle> triangles, Material material = lambert(0.3)) {
  return make_cad_model("shape of a test", std::move(triangles), {std::move(material)});
}

}  // namespace vbar::twins::camera::shapes
