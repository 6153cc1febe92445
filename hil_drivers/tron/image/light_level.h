#pragma once
// The light of the target in an image, against what its lamp and boxes should give: a lamp that is off is seen there
// only, because nothing acknowledges a lighting level.

#include <cstdint>
#include <memory>
#include <span>

#include <Eigen/Geometry>

#include "fsw/core/types.h"
#include "host_sim/twins/camera/camera_settings.h"
#include "host_sim/twins/camera/model/target_renderer.h"

namespace vbar::tron {

/// Holds the light on a target in orbit.
struct TargetLight {
  fsw::Vector3 sun_C = fsw::Vector3::UnitZ();  ///< unit
  double sun_photons_per_m2_s = 0.0;           ///< that reach it
  fsw::Vector3 earth_C = fsw::Vector3::UnitZ();
  double earth_photons_per_m2_s = 0.0;
  double earth_half_angle = 1.1;  ///< rad
};

/// Predicts the light of the CAD model's surfaces towards the camera, which the mock-up's resemble.
class ExpectedLight {
 public:
  explicit ExpectedLight(const twins::camera::CadModel& model) : renderer_(model) {}

  /// Returns photo-electrons in an image of `camera`; `T_C_B`: body at full scale in camera axes.
  [[nodiscard]] double electrons(const Eigen::Isometry3d& T_C_B, const TargetLight& light,
                                 const twins::camera::CameraSettings& camera);

 private:
  twins::camera::TargetRenderer renderer_;
  std::vector<twins::camera::LightSample> samples_;
};

/// Returns photo-electrons of the pixels where `mask` is 1.
[[nodiscard]] double measured_electrons(std::span<const std::uint16_t> dn, std::span<const std::uint8_t> mask,
                                        double offset_dn, double gain_dn_per_electron);

}  // namespace vbar::tron
