#include "fsw/measurements/calibrated_camera.h"

#include "fsw/messaging/message_fields.h"

namespace vbar::fsw::measurements {

bool is_valid(const camera_configuration& camera) {
  return calibrated_camera(camera).ok();
}

Result<CalibratedCamera> calibrated_camera(const camera_configuration& c) {
  const Vector3 position = messaging::vector(c.position_body_m);
  const bool frame_is_usable =
      c.width > 0 && c.height > 0 && c.origin_x >= 0 && c.origin_y >= 0 &&
      static_cast<std::size_t>(c.width) * static_cast<std::size_t>(c.height) <= imaging::kMaxPixels &&
      (c.bits == 8 || c.bits == 12);
  // A pixel without light is not saturated.
  const bool levels_are_usable = messaging::is_between(c.saturation_dn, 1.0, c.bits == 12 ? 4095.0 : 255.0) &&
                                 c.dark_level_dn >= 0.0 && c.dark_level_dn < c.saturation_dn &&
                                 messaging::is_positive(c.noise_dn, 1e3) &&
                                 messaging::is_positive(c.gain_dn_per_electron, 1e3);
  const bool is_usable =
      frame_is_usable && levels_are_usable && messaging::is_between(c.focal_length_px[0], 10.0, 1e6) &&
      messaging::is_between(c.focal_length_px[1], 10.0, 1e6) &&
      messaging::is_between(c.principal_point_px[0], -1e5, 1e5) &&
      messaging::is_between(c.principal_point_px[1], -1e5, 1e5) &&
      messaging::is_between(c.point_spread_sigma_px, 0.3, 3.0) && messaging::is_positive(c.zero_magnitude_dn, 1e12) &&
      messaging::is_rotation(c.q_camera_body) && position.norm() < 100.0;
  if (!is_usable) return Status::kOutOfRange;
  CalibratedCamera camera;
  camera.frame = {c.width, c.height, c.origin_x, c.origin_y, c.bits};
  camera.model.focal_length_px = {c.focal_length_px[0], c.focal_length_px[1]};
  camera.model.principal_point_px = {c.principal_point_px[0], c.principal_point_px[1]};
  for (std::size_t k = 0; k < camera.model.distortion.size(); ++k) camera.model.distortion[k] = c.distortion[k];
  camera.R_camera_body = messaging::rotation(c.q_camera_body);
  camera.position_body_m = position;
  camera.saturation_dn = static_cast<int>(c.saturation_dn);
  return camera;
}

}  // namespace vbar::fsw::measurements
