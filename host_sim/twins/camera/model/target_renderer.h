#pragma once
// What the shaders of surfaces take: materials, and the Earth's light as a table.

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "fsw/core/types.h"
#include "host_sim/twins/camera/model/cad_model.h"
#include "host_sim/twins/camera/object_view.h"

namespace vbar::twins::camera {

/// Returns albedo, reflectivity, the same at grazing incidence, roughness. A reflectivity below 4 %, glass with a
/// coating or plain paint, rises less at grazing incidence; zero stays zero. Roughness from the exponent: Walter et al.
/// (2007), section 5.2.
std::array<float, 4> shader_material(const Material& material);

/// Tabulates earth_light_factor() at even steps of the cosine from -1 to 1.
std::vector<float> earth_table(double sine_earth);

// Light of a spacecraft at any range: its CAD model rendered at its own scale, in linear radiometric units.
//
// The picture is fitted to the sphere around the body and has a number of texels that follows from the apparent
// size; a body of a hundredth of a pixel is rendered with the accuracy of a near one, so its brightness varies with
// attitude and phase as that of a real one.

/// One body and its illumination. Camera axes: z boresight, x right, y down; the body may be out of the field.
struct TargetView {
  fsw::Vector3 position_camera = fsw::Vector3::Zero();  ///< position of the body frame's origin from the camera, m
  fsw::Matrix3 R_camera_body = fsw::Matrix3::Identity();
  fsw::Vector3 sun_camera = fsw::Vector3::UnitZ();    ///< unit vector from the body towards the Sun
  double sun_photons_per_m2_s = 0.0;                  ///< on an area that faces the Sun, out of any shadow
  double sunlit = 1.0;                                ///< visible fraction of the Sun's disc, 0 to 1
  fsw::Vector3 nadir_camera = fsw::Vector3::UnitY();  ///< unit vector from the body to the Earth's centre
  double earth_photons_per_m2_s = 0.0;                ///< from the Earth, on an area that faces the nadir
  double earth_half_angle = 1.1;                      ///< that the Earth's disc subtends, rad, up to pi/2
  double texel_pitch = 0.0;                           ///< largest wanted, rad; 0 for the coarsest picture
};

/// Half-angle of the Earth's disc that a renderer accounts for, rad.
[[nodiscard]] double earth_edge(const TargetView& view);

/// A body that the wanted texels divide into few samples is drawn without OpenGL (distant_body.h), a larger one with
/// it.
class TargetRenderer {
 public:
  static constexpr int kMinTexels = 256;   ///< on a side of a picture drawn with OpenGL
  static constexpr int kMaxTexels = 2048;  ///< larger bodies get larger texels than asked for

  /// Copies the parts of the model that it needs. Throws std::runtime_error if there is no OpenGL.
  explicit TargetRenderer(const CadModel& model);
  ~TargetRenderer();
  TargetRenderer(const TargetRenderer&) = delete;
  TargetRenderer& operator=(const TargetRenderer&) = delete;

  /// Replaces `out` by the light of every texel or square of texels that is not dark, in rows of the picture.
  /// Self-shadowing in sunlight is modelled; interreflection, and the body's shadow in the Earth's light, are not. Same
  /// bits for the same view on the same processor. From any thread, one at a time. Throws std::invalid_argument if a
  /// number is not finite or the camera is inside the sphere around the body.
  void render(const TargetView& view, std::vector<LightSample>& out);

  /// Sets other materials for the faces, as many as the model has. Throws std::runtime_error as check_materials does.
  void set_materials(std::span<const Material> materials);

  /// Returns the number of texels on a side of the last picture.
  [[nodiscard]] int texels() const;

 private:
  struct Drawing;
  std::unique_ptr<Drawing> drawing_;
};

}  // namespace vbar::twins::camera
