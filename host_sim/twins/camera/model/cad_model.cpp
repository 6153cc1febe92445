#include "host_sim/twins/camera/model/cad_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

#include <Eigen/Geometry>
#include <assimp/Importer.hpp>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include "host_sim/files/data_stream.h"

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

// Reading of CAD files, with a check that assimp omits: materials of an OBJ file that no MTL file defines.

namespace {

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& what) {
  throw std::runtime_error(file.string() + ": " + what);
}

// The remainder of a line after its first word, without surrounding blanks.
std::string rest_of(std::istringstream& line) {
  std::string rest;
  std::getline(line >> std::ws, rest);
  rest.erase(rest.find_last_not_of(" \t\r") + 1);
  return rest;
}

// Adds the names of the materials that an MTL file defines with a diffuse colour.
void read_material_names(const std::filesystem::path& file, std::set<std::string>& defined) {
  files::DataStream stream(file);
  if (!stream) refuse(file, "no such material file");
  std::string text, word, material;
  while (std::getline(stream, text)) {
    std::istringstream line(text);
    if (!(line >> word)) continue;
    if (word == "newmtl") material = rest_of(line);
    if (word == "Kd") defined.insert(material);
  }
}

// Errors that assimp does not report: it replaces a material that it cannot find by a grey one and continues.
void check_obj(const CadSource& source) {
  const std::filesystem::path& file = source.file;
  const bool uses_materials = source.materials != CadMaterials::kSurface;
  files::DataStream stream(file);
  std::set<std::string> defined;
  std::string text, word, material;
  bool faces = false;
  for (std::size_t number = 1; std::getline(stream, text); ++number) {
    std::istringstream line(text);
    if (!(line >> word)) continue;
    if (word == "mtllib" && uses_materials) read_material_names(file.parent_path() / rest_of(line), defined);
    if (word == "usemtl") {
      material = rest_of(line);
      if (uses_materials && !defined.contains(material))
        refuse(file,
               fmt::format("line {}: material \"{}\" has no Kd in a material file named before", number, material));
    }
    if (word != "f") continue;
    faces = true;
    if (material.empty() && !source.surface)
      refuse(file, fmt::format("line {}: a face without material; a usemtl line must come before", number));
  }
  if (!faces) refuse(file, "no faces");
}

std::array<double, 3> rgb(const aiColor3D& c) {
  return {c.r, c.g, c.b};
}

Material plain_material(const PlainSurface& surface) {
  Material material;
  material.name = "surface";
  material.diffuse.fill(surface.diffuse);
  material.specular.fill(surface.specular);
  material.exponent = surface.exponent;
  return material;
}

/// The diffuse and the specular part of a material that reflects more than it receives, each divided by the sum.
void scale(Material& material) {
  const double sum = material.grey_diffuse() + material.grey_specular();
  if (sum <= 1.0) return;
  for (std::array<double, 3>* part : {&material.diffuse, &material.specular})
    for (double& channel : *part) channel /= sum;
}

Material material_of(const CadSource& source, const aiMaterial& from) {
  if (source.materials == CadMaterials::kSurface) return plain_material(source.surface.value());
  Material material;
  material.name = from.GetName().C_Str();
  aiColor3D diffuse, specular;
  if (from.Get(AI_MATKEY_COLOR_DIFFUSE, diffuse) != AI_SUCCESS || material.name == AI_DEFAULT_MATERIAL_NAME) {
    if (source.surface) return plain_material(*source.surface);
    refuse(source.file,
           fmt::format("material \"{}\" has no diffuse colour; [cad] of a body file can name a surface for it",
                       material.name));
  }
  material.diffuse = rgb(diffuse);
  if (from.Get(AI_MATKEY_COLOR_SPECULAR, specular) == AI_SUCCESS) material.specular = rgb(specular);
  ai_real exponent = 0.0F;
  if (from.Get(AI_MATKEY_SHININESS, exponent) == AI_SUCCESS) material.exponent = exponent;
  if (source.materials == CadMaterials::kScaled) scale(material);
  return material;
}

Vector3 vector_of(const aiVector3D& v) {
  return {v.x, v.y, v.z};
}

void add_triangles(const CadSource& source, const aiMesh& mesh, std::size_t material,
                   std::vector<Triangle>& triangles) {
  const fsw::Matrix3& R = source.R_body_file;
  for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
    const aiFace& face = mesh.mFaces[f];
    if (face.mNumIndices != 3) continue;
    Triangle triangle;
    triangle.material = material;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vector3 corner = source.unit_m * vector_of(mesh.mVertices[face.mIndices[k]]) - source.origin_m;
      triangle.corners[k] = R * corner;
      triangle.normals[k] =
          mesh.HasNormals() ? Vector3(R * vector_of(mesh.mNormals[face.mIndices[k]])) : Vector3::Zero();
    }
    triangles.push_back(triangle);
  }
}

}  // namespace

CadModel load_cad_model(const std::filesystem::path& file) {
  return load_cad_model(CadSource{.file = file});
}

CadModel load_cad_model(const CadSource& source) {
  const std::filesystem::path& file = source.file;
  if (!std::filesystem::is_regular_file(file)) refuse(file, "no such file");
  if (file.extension() == ".obj") check_obj(source);
  Assimp::Importer importer;
  // Points and lines are not part of the surface and are removed. Transformations of a scene's parts are applied.
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  const aiScene* const scene =
      importer.ReadFile(file.string(), aiProcess_Triangulate | aiProcess_PreTransformVertices | aiProcess_SortByPType);
  if (scene == nullptr) refuse(file, fmt::format("no CAD file that can be read: {}", importer.GetErrorString()));
  std::vector<Material> materials;
  std::vector<Triangle> triangles;
  std::map<unsigned, std::size_t>
      index;  // indices of the materials that faces use; assimp adds a default to every file
  for (unsigned m = 0; m < scene->mNumMeshes; ++m) {
    const aiMesh& mesh = *scene->mMeshes[m];
    const unsigned used = source.materials == CadMaterials::kSurface ? 0 : mesh.mMaterialIndex;
    const auto [place, added] = index.try_emplace(used, materials.size());
    if (added) materials.push_back(material_of(source, *scene->mMaterials[mesh.mMaterialIndex]));
    add_triangles(source, mesh, place->second, triangles);
  }
  return make_cad_model(file.string(), std::move(triangles), std::move(materials));
}

}  // namespace vbar::twins::camera
