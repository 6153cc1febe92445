// Telecommands of camera and angles-only navigation, checked.

#include "fsw/gnc/camera_navigation.h"
#include "fsw/gnc/message_fields.h"

namespace vbar::fsw::gnc {
namespace {

bool is_between(double x, double least, double most) {
  return x >= least && x <= most;
}

bool is_above(double x, double most) {
  return x > 0.0 && x <= most;
}

}  // namespace

Result<angles_only::CameraSettings> camera_settings(const camera_configuration& c, const angles_only_configuration& a) {
  const Vector3 position = vector(c.position_body_m);
  const bool frame_is_usable =
      c.width > 0 && c.height > 0 && c.origin_x >= 0 && c.origin_y >= 0 &&
      static_cast<std::size_t>(c.width) * static_cast<std::size_t>(c.height) <= imaging::kMaxPixels &&
      (c.bits == 8 || c.bits == 12);
  const bool is_usable =
      frame_is_usable && is_between(c.focal_length_px[0], 10.0, 1e6) && is_between(c.focal_length_px[1], 10.0, 1e6) &&
      is_between(c.principal_point_px[0], -1e5, 1e5) && is_between(c.principal_point_px[1], -1e5, 1e5) &&
      is_between(c.point_spread_sigma_px, 0.3, 3.0) && is_above(c.zero_magnitude_dn, 1e12) &&
      is_between(c.saturation_dn, 1.0, c.bits == 12 ? 4095.0 : 255.0) && is_above(c.gain_dn_per_electron, 1e3) &&
      is_rotation(c.q_camera_body) && position.norm() < 100.0 && is_between(a.detection_sigmas, 1.0, 30.0) &&
      is_between(a.centroid_floor_px, 0.0, 10.0) && is_above(a.pointing_tolerance, stars::kLargestTolerance);
  if (!is_usable) return Status::kOutOfRange;
  angles_only::CameraSettings settings;
  settings.frame = {c.width, c.height, c.origin_x, c.origin_y, c.bits};
  settings.model.focal_length_px = {c.focal_length_px[0], c.focal_length_px[1]};
  settings.model.principal_point_px = {c.principal_point_px[0], c.principal_point_px[1]};
  for (std::size_t k = 0; k < settings.model.distortion.size(); ++k) settings.model.distortion[k] = c.distortion[k];
  settings.detector.detection_sigmas = a.detection_sigmas;
  settings.detector.gain_dn_per_electron = c.gain_dn_per_electron;
  settings.detector.saturation_dn = static_cast<int>(c.saturation_dn);
  settings.detector.point_spread_sigma_px = c.point_spread_sigma_px;
  settings.zero_magnitude_dn = c.zero_magnitude_dn;
  settings.R_camera_body = rotation(c.q_camera_body);
  settings.position_body_m = position;
  settings.centroid_floor_px = a.centroid_floor_px;
  settings.pointing_tolerance = a.pointing_tolerance;
  return settings;
}

Result<navigation::AnglesOnlySettings> angles_only_settings(const angles_only_configuration& a,
                                                            const orbit::EarthOrientation& earth) {
  const bool is_usable = is_above(a.acceleration_psd, 1.0) && is_above(a.acceleration_psd_least, a.acceleration_psd) &&
                         is_between(a.acceleration_psd_most, a.acceleration_psd, 1.0) &&
                         is_between(a.brightness_offset_m, 0.0, 100.0) && is_between(a.maneuver_sigma, 0.0, 1.0) &&
                         is_between(a.maneuver_sigma_relative, 0.0, 1.0) && a.batch_images >= 10 &&
                         a.batch_images <= static_cast<std::int32_t>(navigation::BearingBatch::kCapacity);
  if (!is_usable) return Status::kOutOfRange;
  navigation::AnglesOnlySettings settings;
  settings.filter.acceleration = {a.acceleration_psd, a.acceleration_psd_least, a.acceleration_psd_most};
  settings.filter.brightness_offset_sigma_m = a.brightness_offset_m;
  settings.filter.maneuver_sigma = a.maneuver_sigma;
  settings.filter.maneuver_sigma_relative = a.maneuver_sigma_relative;
  settings.batch.bearings = a.batch_images;
  settings.earth = earth;
  return settings;
}

}  // namespace vbar::fsw::gnc
