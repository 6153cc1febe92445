#pragma once
// Visibility of the faces of a body to a distant viewer, the camera or the Sun: the nearest face of each texel, and
// from it the fraction of a small part of the surface that is visible.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "fsw/core/types.h"
#include "host_sim/twins/camera/model/cad_model.h"
#include "host_sim/twins/camera/model/reflection.h"

namespace vbar::twins::camera {

/// A triangle of a model in single precision: positions from the middle of the sphere, in radii of the sphere.
struct Face {
  std::array<glsl::vec3, 3> corners, normals;
  glsl::vec3 flat_normal{};
  std::uint32_t material = 0;
};

/// Rounds to single precision.
[[nodiscard]] glsl::vec3 single(const fsw::Vector3& v);

[[nodiscard]] std::vector<Face> faces_of(const CadModel& model);

/// Direction and distance of a viewer.
struct Viewer {
  std::array<glsl::vec3, 3> R_viewer_body;  ///< rows: two axes across, then away from the viewer
  float reach = 0.0F;                       ///< radius of the sphere over its distance; 0: at infinity
  float half_width = 1.0F;                  ///< of the map at the sphere's middle, radii
};

class FaceMap {
 public:
  /// Place of a point, in texels from the middle of the map. Depth is the distance from the sphere's middle along the
  /// view over the point's distance, so that that of a plane is linear in x and y.
  struct Place {
    float x, y, depth;
  };

  /// `size`: texels on a side, even.
  explicit FaceMap(int size);

  /// Finds the nearest face of each texel.
  void draw(std::span<const Face> faces, const Viewer& viewer);

  [[nodiscard]] Place place_of(glsl::vec3 point) const;

  /// Visibility of a face in the texels that it covers; kSome for few texels.
  enum class Extent : std::uint8_t { kNone, kSome, kAll };
  [[nodiscard]] Extent extent(std::size_t face) const { return extents_[face]; }

  /// Returns the visible fraction of the surroundings of a point of `face`, about a texel wide: 0 to 1.
  [[nodiscard]] float visible(std::size_t face, glsl::vec3 point) const;

 private:
  /// Depth of the plane of a face over the map.
  struct Plane {
    float at_middle, along_x, along_y;
  };
  static constexpr std::int32_t kNone = -1;

  void fill(std::int32_t face, const std::array<Place, 3>& corners);
  void count_visible();

  int size_;
  Viewer viewer_;
  std::vector<Plane> planes_;
  std::vector<float> depths_;
  std::vector<std::int32_t> nearest_;
  std::vector<std::int32_t> covered_, won_;  // texels of each face
  std::vector<Extent> extents_;
};

}  // namespace vbar::twins::camera
