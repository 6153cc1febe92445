#include "host_sim/truth/attitude/body.h"

#include <cmath>
#include <cstddef>
#include <stdexcept>

#include <Eigen/Geometry>

namespace vbar::truth {

using fsw::Vector3;

Facet facet_of_polygon(const std::vector<Vector3>& corners_m, double specular, double diffuse) {
  if (corners_m.size() < 3) throw std::invalid_argument("a facet needs three corners or more");
  if (!(specular >= 0.0 && diffuse >= 0.0 && specular + diffuse <= 1.0)) {
    throw std::invalid_argument("a facet's reflectivities must not be negative nor add to more than 1");
  }
  // A fan of triangles about the first corner.
  Vector3 doubled_area = Vector3::Zero();
  for (std::size_t k = 2; k < corners_m.size(); ++k) {
    doubled_area += (corners_m[k - 1] - corners_m[0]).cross(corners_m[k] - corners_m[0]);
  }
  Facet facet{.area_m2 = 0.5 * doubled_area.norm(), .specular = specular, .diffuse = diffuse};
  if (!(facet.area_m2 > 0.0)) throw std::invalid_argument("a facet has no area");
  facet.normal = doubled_area.normalized();
  for (std::size_t k = 2; k < corners_m.size(); ++k) {
    const Vector3 a = corners_m[k - 1] - corners_m[0], b = corners_m[k] - corners_m[0];
    if (!(std::abs(facet.normal.dot(b)) <= 1e-6 * b.norm())) {
      throw std::invalid_argument("a facet's corners do not lie in one plane");
    }
    const double share = 0.5 * facet.normal.dot(a.cross(b)) / facet.area_m2;
    facet.centre_m += share * (corners_m[0] + (a + b) / 3.0);
  }
  return facet;
}

}  // namespace vbar::truth
