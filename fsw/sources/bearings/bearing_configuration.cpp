#include "fsw/sources/bearings/bearing_configuration.h"

#include "fsw/sources/calibrated_camera.h"
#include "fsw/sources/valid_range.h"

namespace vbar::fsw::sources {

bool is_valid(const angles_only_configuration& a) {
  return is_between(a.exposure_s, 0.0, kLongestExposure_s) && is_between(a.detection_sigmas, 1.0, 30.0) &&
         is_between(a.centroid_floor_px, 0.0, 10.0) && is_positive(a.pointing_tolerance, stars::kLargestTolerance) &&
         is_between(a.brightness_offset_m, 0.0, 100.0) && is_between(a.centroid_noise_m, 0.0, 100.0) &&
         is_positive(a.bearing_bias, 0.1) && a.batch_images >= 10 &&
         a.batch_images <= static_cast<std::int32_t>(navigation::BearingBatch::kCapacity);
}

Result<angles_only::CameraSettings> camera_settings(const camera_configuration& c, const angles_only_configuration& a) {
  const Result<CalibratedCamera> camera = calibrated_camera(c);
  if (!camera.ok() || !is_valid(a)) return Status::kOutOfRange;
  angles_only::CameraSettings settings;
  settings.frame = camera.value().frame;
  settings.model = camera.value().model;
  settings.detector.detection_sigmas = a.detection_sigmas;
  settings.detector.gain_dn_per_electron = c.gain_dn_per_electron;
  settings.detector.saturation_dn = camera.value().saturation_dn;
  settings.detector.point_spread_sigma_px = c.point_spread_sigma_px;
  settings.zero_magnitude_dn = c.zero_magnitude_dn;
  settings.R_camera_body = camera.value().R_camera_body;
  settings.position_body_m = camera.value().position_body_m;
  settings.centroid_floor_px = a.centroid_floor_px;
  settings.pointing_tolerance = a.pointing_tolerance;
  return settings;
}

Result<BearingSettings> bearing_settings(const angles_only_configuration& a) {
  if (!is_valid(a)) return Status::kOutOfRange;
  BearingSettings settings;
  settings.batch.bearings = a.batch_images;
  settings.batch.bias_sigma = a.bearing_bias;
  settings.model.centroid_noise_m = a.centroid_noise_m;
  return settings;
}

}  // namespace vbar::fsw::sources
