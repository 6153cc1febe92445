#pragma once
// Light of a body that covers few pixels, without OpenGL: that of small pieces of its surface, each as far as the
// camera and the Sun see it.
//
// A piece has its exact area, so that outlines need no fine picture. The light depends on the sizes of pieces and of
// texels of the two maps only where one part of the body hides or shades another one.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "fsw/core/types.h"
#include "host_sim/twins/camera/model/face_map.h"
#include "host_sim/twins/camera/model/reflection.h"
#include "host_sim/twins/camera/model/target_renderer.h"
#include "host_sim/twins/camera/object_view.h"

namespace vbar::twins::camera {

/// A square picture that is fitted to the sphere around the body.
struct PictureGeometry {
  fsw::Vector3 centre_camera;     ///< middle of the sphere, m
  double radius_m = 0.0;          ///< of the sphere
  double reach = 0.0;             ///< radius of the sphere over its distance
  double tan_half = 0.0;          ///< half width of the picture at unit distance
  fsw::Matrix3 R_picture_camera;  ///< z to the middle of the sphere
  fsw::Matrix3 R_sun_body;        ///< z away from the Sun
  double scale = 1.0;             ///< photons/(m^2 s) that the light is computed in units of
};

class DistantBody {
 public:
  static constexpr int kTexels = 384;                 ///< on a side of the map of what the camera sees
  static constexpr int kSunTexels = 320;              ///< on a side of that of what the Sun sees
  static constexpr int kSamples = 48;                 ///< on a side, of the light that is returned
  static constexpr float kPiece = 0.06F;              ///< longest side of a piece, radii of the sphere
  static constexpr float kBend = 0.2F;                ///< largest angle between normals in a piece, rad
  static constexpr int kHalvings = 3;                 ///< of a piece: it has a point in each of 2^kHalvings parts
  static constexpr std::size_t kManyPieces = 20'000;  ///< larger pieces rather than more than these

  /// `faces` must outlive the object.
  explicit DistantBody(std::span<const Face> faces);

  /// Appends the light as at most kSamples^2 samples, each the sum of the pieces in a square at their centroid.
  /// `materials` as shader_material() gives them; `earth_table`: irradiance by the Earth over the cosine to the nadir,
  /// empty without its light.
  void draw(const TargetView& view, const PictureGeometry& geometry, std::span<const std::array<float, 4>> materials,
            std::span<const float> earth_table, std::vector<LightSample>& out);

 private:
  /// A triangle of the surface: its middle, and points spread over it that are visible or not.
  struct Piece {
    glsl::vec3 place, normal;
    float area;  // radii^2
    std::uint32_t face;
    std::array<glsl::vec3, std::size_t{1} << kHalvings> points;
  };
  using Triple = std::array<glsl::vec3, 3>;
  struct Light;
  struct Block;
  struct Square {
    double light = 0.0, x = 0.0, y = 0.0;  // moments of the light
  };

  void cut(std::uint32_t face, const Triple& weights, float longest);
  void spread(const Triple& corners, int halvings, glsl::vec3*& next);
  [[nodiscard]] Light light_of(const TargetView& view, const PictureGeometry& geometry,
                               std::span<const std::array<float, 4>> materials,
                               std::span<const float> earth_table) const;
  void take(const Light& light, const Piece& piece, Block& block) const;
  static void reflect_light(const Light& light, Block& block);
  void add(const Block& block);
  void give_samples(const PictureGeometry& geometry, std::vector<LightSample>& out) const;

  std::span<const Face> faces_;
  std::vector<Piece> pieces_;
  std::size_t points_ = 0;
  FaceMap seen_by_camera_, seen_by_sun_;
  std::vector<Square> squares_;
};

}  // namespace vbar::twins::camera
