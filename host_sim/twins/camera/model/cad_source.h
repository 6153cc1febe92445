#pragma once
// Where the shape of a spacecraft comes from, and how the coordinates of its CAD file become those of the body frame.

#include <filesystem>
#include <optional>

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

}  // namespace vbar::twins::camera
