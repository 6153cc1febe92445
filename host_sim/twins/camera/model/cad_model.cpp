#include "host_sim/twins/camera/model/cad_model.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>

namespace vbar::twins::camera {
namespace {

using fsw::Vector3;

[[noreturn]] void refuse(const std::string& source, const std::string& what) {
  throw std::runtime_error(source + ": " + what);
}

double area(const Triangle& t) {
  return 0.5 * (t.corners[1] - t.corners[0]).cross(t.corners[2] - t.corners[0]).norm();
}

void check_finite(const std::string& source, const std::vector<Triangle>& triangles) {
  for (std::size_t i = 0; i < triangles.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k)
      if (!triangles[i].corners[k].allFinite() || !triangles[i].normals[k].allFinite())
        refuse(source, fmt::format("corner {} of triangle {} is not finite", k + 1, i + 1));
}

// Ritter (1990), "An efficient bounding sphere", started at the centre of the bounding box: within some per cent of the
// smallest sphere.
void find_sphere(CadModel& model) {
  Vector3 low = model.triangles[0].corners[0], high = low;
  for (const Triangle& t : model.triangles)
    for (const Vector3& p : t.corners) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
  const Vector3 middle = 0.5 * (low + high);
  double middle_radius = 0.0;
  for (const Triangle& t : model.triangles)
    for (const Vector3& p : t.corners) middle_radius = std::max(middle_radius, (p - middle).norm());
  Vector3 centre = middle;
  double radius = 0.5 * (high - low).maxCoeff();
  for (const Triangle& t : model.triangles)
    for (const Vector3& p : t.corners) {
      const double distance = (p - centre).norm();
      if (distance <= radius) continue;
      const double grown = 0.5 * (radius + distance);
      centre += (distance - grown) / distance * (p - centre);
      radius = grown;
    }
  model.centre = radius < middle_radius ? centre : middle;
  model.radius_m = 0.0;
  for (const Triangle& t : model.triangles)
    for (const Vector3& p : t.corners) model.radius_m = std::max(model.radius_m, (p - model.centre).norm());
}

void drop_faces_without_area(CadModel& model) {
  // Coordinates of CAD files carry six digits: less than a millionth of the size squared is rounding.
  const double least = 1e-12 * model.radius_m * model.radius_m;
  const std::size_t before = model.triangles.size();
  std::erase_if(model.triangles, [least](const Triangle& t) { return !(area(t) > least); });
  model.faces_without_area = before - model.triangles.size();
  if (100 * model.faces_without_area > before)
    refuse(model.source,
           fmt::format("{} of {} triangles have no area; accepted is 1 %", model.faces_without_area, before));
}

// Without a normal in the file the face is flat.
void complete_normals(Triangle& t) {
  const Vector3 flat = (t.corners[1] - t.corners[0]).cross(t.corners[2] - t.corners[0]).normalized();
  for (Vector3& normal : t.normals) normal = normal.norm() > 1e-6 ? Vector3(normal.normalized()) : flat;
}

}  // namespace

void check_materials(const std::string& source, const std::vector<Material>& materials) {
  if (materials.empty()) refuse(source, "no materials");
  if (materials.size() > kMaxMaterials)
    refuse(source, fmt::format("{} materials; accepted are {}", materials.size(), kMaxMaterials));
  for (const Material& m : materials) {
    const auto in_range = [](double value) { return value >= 0.0 && value <= 1.0; };
    for (std::size_t k = 0; k < 3; ++k)
      if (!in_range(m.diffuse[k]) || !in_range(m.specular[k]))
        refuse(source, fmt::format("material \"{}\": Kd {} and Ks {} must lie between 0 and 1", m.name, m.diffuse[k],
                                   m.specular[k]));
    if (m.grey_diffuse() + m.grey_specular() > 1.0 + 1e-6)
      refuse(source,
             fmt::format("material \"{}\" reflects more than it receives: Kd {:.3f} and Ks {:.3f} (means of "
                         "red, green, blue) add up to more than 1; [cad] of a body file accepts it with "
                         "materials = \"scaled\" (both divided by their sum) or \"surface\" (cad.surface for all "
                         "faces)",
                         m.name, m.grey_diffuse(), m.grey_specular()));
    if (!(m.exponent >= 0.0 && m.exponent <= 1e4))
      refuse(source, fmt::format("material \"{}\": Ns {} must lie between 0 and 10000", m.name, m.exponent));
  }
}

CadModel make_cad_model(std::string source, std::vector<Triangle> triangles, std::vector<Material> materials) {
  CadModel model;
  model.source = std::move(source);
  model.triangles = std::move(triangles);
  model.materials = std::move(materials);
  if (model.triangles.empty()) refuse(model.source, "no faces");
  check_finite(model.source, model.triangles);
  check_materials(model.source, model.materials);
  for (const Triangle& t : model.triangles)
    if (t.material >= model.materials.size()) refuse(model.source, "a face has no material");
  find_sphere(model);
  if (!(model.radius_m >= kMinModelRadiusM && model.radius_m <= kMaxModelRadiusM))
    refuse(model.source,
           fmt::format("the body fits a sphere of radius {:.4g} m; accepted are {} m to {} m: coordinates "
                       "must be metres",
                       model.radius_m, kMinModelRadiusM, kMaxModelRadiusM));
  drop_faces_without_area(model);
  for (Triangle& t : model.triangles) complete_normals(t);
  return model;
}

}  // namespace vbar::twins::camera
