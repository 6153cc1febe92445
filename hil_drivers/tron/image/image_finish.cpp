#include "hil_drivers/tron/image/image_finish.h"

#include <algorithm>
#include <utility>

#include "hil_drivers/tron/image/binning.h"

namespace vbar::tron {
namespace {

twins::camera::CadModel diffuse_only(twins::camera::CadModel model) {
  for (twins::camera::Material& material : model.materials) material.specular = {};
  return model;
}

}  // namespace

ImageFinish::ImageFinish(const twins::camera::CameraSettings& camera, const twins::camera::CadModel& model,
                         const std::vector<std::uint16_t>& dark, std::uint64_t key)
    : camera_(camera),
      lens_(camera),
      silhouette_(model),
      expected_(model),
      expected_diffuse_(diffuse_only(model)),
      dark_(dark_level(binned(dark))),
      key_(key) {}

std::vector<std::uint16_t> ImageFinish::binned(const std::vector<std::uint16_t>& frame) const {
  return binned_by_two(frame, 2 * camera_.region.width, 2 * camera_.region.height);
}

FinishedImage ImageFinish::finish(const std::vector<std::uint16_t>& frame, std::int64_t image,
                                  const Eigen::Isometry3d& T_C_B, const std::optional<TargetLight>& light) {
  FinishedImage finished;
  finished.dn = binned(frame);
  std::vector<std::uint8_t> mask(finished.dn.size(), 0);
  if (light) {
    Outline outline = outline_of(silhouette_, lens_, T_C_B, camera_.region);
    subtract_background(outline, dark_, finished.dn);
    mask = std::move(outline.mask);
    TargetLight sunlight = *light, earth_light = *light;
    sunlight.earth_photons_per_m2_s = earth_light.sun_photons_per_m2_s = 0.0;
    const double of_sun = expected_.electrons(T_C_B, sunlight, camera_);
    const double of_earth = expected_.electrons(T_C_B, earth_light, camera_);
    const double measured =
        measured_electrons(finished.dn, mask, dark_.offset_dn, camera_.detector.gain_dn_per_electron);
    // With fewer electrons the noise of the mask's pixels decides.
    constexpr double kLeast = 1e5;
    if (of_sun + of_earth > kLeast) finished.light_level = measured / (of_sun + of_earth);
    const double of_sun_diffuse = expected_diffuse_.electrons(T_C_B, sunlight, camera_);
    if (of_sun_diffuse > std::max(kLeast, of_earth)) finished.sunlight_level = (measured - of_earth) / of_sun_diffuse;
  }
  const auto full_scale = static_cast<std::uint16_t>((1U << static_cast<unsigned>(camera_.detector.bits)) - 1U);
  replace_background(mask, dark_, key_, image, full_scale, finished.dn);
  return finished;
}

}  // namespace vbar::tron
