// Reading of CAD files, with a check that assimp omits: materials of an OBJ file that no MTL file defines.

#include <array>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

#include <assimp/Importer.hpp>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include "host_sim/files/data_stream.h"
#include "host_sim/twins/camera/model/cad_model.h"

namespace vbar::twins::camera {
namespace {

using fsw::Vector3;

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
