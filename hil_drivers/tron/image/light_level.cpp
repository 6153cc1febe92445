#include "hil_drivers/tron/image/light_level.h"

#include <cmath>

namespace vbar::tron {

double ExpectedLight::electrons(const Eigen::Isometry3d& T_C_B, const TargetLight& light,
                                const twins::camera::CameraSettings& camera) {
  twins::camera::TargetView view;
  view.position_camera = T_C_B.translation();
  view.R_camera_body = T_C_B.linear();
  view.sun_camera = light.sun_C;
  view.sun_photons_per_m2_s = light.sun_photons_per_m2_s;
  view.nadir_camera = light.earth_C;
  view.earth_photons_per_m2_s = light.earth_photons_per_m2_s;
  view.earth_half_angle = light.earth_half_angle;
  renderer_.render(view, samples_);
  double photons = 0.0;
  for (const twins::camera::LightSample& sample : samples_) photons += sample.photons_per_m2_s;
  return photons * camera.electrons_per_photon_m2() * camera.exposure_s;
}

double measured_electrons(std::span<const std::uint16_t> dn, std::span<const std::uint8_t> mask, double offset_dn,
                          double gain_dn_per_electron) {
  double sum = 0.0, pixels = 0.0;
  for (std::size_t k = 0; k < dn.size() && k < mask.size(); ++k) {
    if (mask[k] == 0) continue;
    sum += dn[k];
    pixels += 1.0;
  }
  return (sum - pixels * offset_dn) / gain_dn_per_electron;
}

}  // namespace vbar::tron
