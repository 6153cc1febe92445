#pragma once
// Where the shape of a spacecraft comes from, and how the coordinates of its CAD file become those of the body frame.

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "fsw/core/types.h"

namespace vbar::twins::camera {

/// Reflectivities of faces that no material of the file describes, as in an STL file, or of all of them.
struct PlainSurface {
  double diffuse = 0.0, specular = 0.0, exponent = 0.0;
};

/// Source of the reflectivities of the faces.
enum class CadMaterials {
  kFile,     ///< those of the file; rejected where they reflect more than they receive
  kScaled,   ///< those of the file, both parts divided by their sum where that is more than 1
  kSurface,  ///< the surface, whatever materials the file has
};

/// File and its axes: a point p of the file lies at R_body_file (unit_m p - origin_m) in the body frame.
struct CadSource {
  std::filesystem::path file;
  double unit_m = 1.0;                           ///< the unit of the file's coordinates
  fsw::Vector3 origin_m = fsw::Vector3::Zero();  ///< origin of the body frame, along the axes of the file
  fsw::Matrix3 R_body_file = fsw::Matrix3::Identity();
  std::optional<PlainSurface> surface{};
  CadMaterials materials = CadMaterials::kFile;
};

// A spacecraft's shape and surface, from a CAD file that assimp can read (OBJ with MTL and others).

/// Reflection of a surface. Red, green, blue, linear; a monochrome camera uses the mean of the three.
struct Material {
  std::string name;
  std::array<double, 3> diffuse{};   ///< albedo of the Lambert part (Kd of an MTL file)
  std::array<double, 3> specular{};  ///< reflectivity of the specular part at normal incidence (Ks)
  double exponent = 0.0;             ///< exponent of the specular lobe (Ns): 0 dull, 1000 nearly a mirror

  [[nodiscard]] double grey_diffuse() const { return (diffuse[0] + diffuse[1] + diffuse[2]) / 3.0; }
  [[nodiscard]] double grey_specular() const { return (specular[0] + specular[1] + specular[2]) / 3.0; }
};

struct Triangle {
  std::array<fsw::Vector3, 3> corners;  ///< body frame, m
  std::array<fsw::Vector3, 3>
      normals;               ///< normals of the smooth surface at the corners, unit vectors; zero: the face is flat
  std::size_t material = 0;  ///< index of CadModel::materials
};

struct CadModel {
  std::string source;  ///< name in messages: the file
  std::vector<Material> materials;
  std::vector<Triangle> triangles;
  fsw::Vector3 centre = fsw::Vector3::Zero();  ///< centre of a sphere around everything, body frame, m
  double radius_m = 0.0;
  std::size_t faces_without_area = 0;  ///< number of faces of the file that are not in `triangles`
};

inline constexpr std::size_t kMaxMaterials = 64;
inline constexpr double kMinModelRadiusM = 0.05;
inline constexpr double kMaxModelRadiusM = 100.0;

/// Makes a model of these triangles with its bounding sphere, without the faces of zero area. Throws
/// std::runtime_error, naming `source` and what is wrong: no faces, a corner that is not finite, more than 1 % of the
/// faces without area, a sphere outside kMinModelRadiusM to kMaxModelRadiusM, no or too many materials.
CadModel make_cad_model(std::string source, std::vector<Triangle> triangles, std::vector<Material> materials);

/// Throws std::runtime_error, naming `source` and the material, unless reflectivities lie in 0 to 1, the grey of both
/// together reflects no more than all light, and the exponent lies in 0 to 10,000.
void check_materials(const std::string& source, const std::vector<Material>& materials);

/// Reads a CAD file, in body axes. Throws std::runtime_error with one message that names the file and what is wrong: as
/// make_cad_model, and: no such file, a file assimp does not understand, a face whose material no file defines unless
/// the source names a surface for it.
CadModel load_cad_model(const CadSource& source);

/// Reads a CAD file in metres and body axes.
CadModel load_cad_model(const std::filesystem::path& file);

}  // namespace vbar::twins::camera
