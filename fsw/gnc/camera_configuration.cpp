#include "fsw/gnc/camera_configuration.h"

#include "fsw/gnc/inbox.h"
#include "fsw/gnc/message_fields.h"
#include "fsw/math/symmetric_eigen.h"

namespace vbar::fsw::gnc {
namespace {

bool is_between(double x, double minimum, double maximum) {
  return x >= minimum && x <= maximum;
}

bool is_above(double x, double maximum) {
  return x > 0.0 && x <= maximum;
}

/// kOutOfRange unless positive definite and no principal moment exceeds the sum of the other two.
Result<navigation::Inertia> inertia_of(const pose_configuration& p) {
  Matrix3 inertia;
  inertia << p.inertia_kgm2[0], p.inertia_kgm2[3], p.inertia_kgm2[4],  //
      p.inertia_kgm2[3], p.inertia_kgm2[1], p.inertia_kgm2[5],         //
      p.inertia_kgm2[4], p.inertia_kgm2[5], p.inertia_kgm2[2];
  const auto eigen = math::symmetric_eigen(inertia);
  if (!eigen.ok()) return Status::kOutOfRange;
  const Vector3& moments = eigen.value().values;  // increasing
  const bool is_body = moments(0) > 1e-6 && moments(2) < 1e7 && moments(2) <= 1.0001 * (moments(0) + moments(1));
  if (!is_body) return Status::kOutOfRange;
  return navigation::inertia_of(inertia);
}

/// kOutOfRange if the points are nearly coincident or collinear, or too far from the origin for any target.
Result<pose::KeypointShape> keypoint_shape(const pose_configuration& p) {
  pose::KeypointShape shape{};
  Matrix3 spread = Matrix3::Zero();
  for (std::size_t k = 0; k < shape.size(); ++k) {
    for (int axis = 0; axis < 3; ++axis) shape[k](axis) = p.keypoints_body_m[3 * k + static_cast<std::size_t>(axis)];
    if (!(shape[k].norm() < 100.0)) return Status::kOutOfRange;
    spread += shape[k] * shape[k].transpose();
  }
  const auto eigen = math::symmetric_eigen(spread);
  if (!eigen.ok() || !(eigen.value().values(1) > 1e-4)) return Status::kOutOfRange;
  return shape;
}

bool has_valid_network(const pose_configuration& p) {
  return is_between(p.dark_level_dn, 0.0, 4095.0) && is_above(p.noise_dn, 1e3);
}

bool has_apriori(const pose_configuration& p) {
  return !vector(p.apriori_sigma_a_roe_m).isZero(0.0);
}

bool has_valid_orbits(const pose_configuration& p) {
  const auto is_sigma = [](const Vector6& sigma) { return (sigma.array() > 0.0).all() && (sigma.array() < 1e6).all(); };
  const bool apriori_is_valid = is_usable(GpsTime{p.apriori_epoch_ns}) && is_sigma(vector(p.apriori_sigma_a_roe_m)) &&
                                (vector(p.apriori_a_roe_m).array().abs() < 1e6).all();
  return is_sigma(vector(p.start_sigma_a_roe_m)) && (!has_apriori(p) || apriori_is_valid);
}

}  // namespace

bool is_valid(const camera_configuration& camera) {
  return calibrated_camera(camera).ok();
}

bool is_valid(const angles_only_configuration& a) {
  return is_between(a.detection_sigmas, 1.0, 30.0) && is_between(a.centroid_floor_px, 0.0, 10.0) &&
         is_above(a.pointing_tolerance, stars::kLargestTolerance) && is_above(a.acceleration_psd, 1.0) &&
         is_above(a.acceleration_psd_least, a.acceleration_psd) &&
         is_between(a.acceleration_psd_most, a.acceleration_psd, 1.0) &&
         is_between(a.brightness_offset_m, 0.0, 100.0) && is_between(a.centroid_noise_m, 0.0, 100.0) &&
         is_above(a.bearing_bias, 0.1) && is_between(a.maneuver_sigma, 0.0, 1.0) &&
         is_between(a.maneuver_sigma_relative, 0.0, 1.0) && a.batch_images >= 10 &&
         a.batch_images <= static_cast<std::int32_t>(navigation::BearingBatch::kCapacity);
}

bool is_valid(const pose_configuration& p) {
  return has_valid_network(p) && keypoint_shape(p).ok() && inertia_of(p).ok() && has_valid_orbits(p) &&
         is_above(p.keypoint_sigma_scale, 100.0) && is_between(p.keypoint_floor_px, 0.0, 100.0) &&
         is_above(p.acceleration_psd, 1.0) && is_above(p.acceleration_psd_least, p.acceleration_psd) &&
         is_between(p.acceleration_psd_most, p.acceleration_psd, 1.0) && is_above(p.angular_acceleration_psd, 1.0) &&
         is_between(p.maneuver_sigma, 0.0, 1.0) && is_between(p.maneuver_sigma_relative, 0.0, 1.0) &&
         p.start_images >= 1 && p.start_images <= static_cast<std::int32_t>(navigation::PoseInitialiser::kMaxSamples);
}

bool agree(const camera_configuration& camera, const pose_configuration& configuration) {
  return configuration.dark_level_dn < camera.saturation_dn;
}

Result<CalibratedCamera> calibrated_camera(const camera_configuration& c) {
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
      is_rotation(c.q_camera_body) && position.norm() < 100.0;
  if (!is_usable) return Status::kOutOfRange;
  CalibratedCamera camera;
  camera.frame = {c.width, c.height, c.origin_x, c.origin_y, c.bits};
  camera.model.focal_length_px = {c.focal_length_px[0], c.focal_length_px[1]};
  camera.model.principal_point_px = {c.principal_point_px[0], c.principal_point_px[1]};
  for (std::size_t k = 0; k < camera.model.distortion.size(); ++k) camera.model.distortion[k] = c.distortion[k];
  camera.R_camera_body = rotation(c.q_camera_body);
  camera.position_body_m = position;
  camera.saturation_dn = static_cast<int>(c.saturation_dn);
  return camera;
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

Result<BearingNavigationSettings> bearing_settings(const angles_only_configuration& a) {
  if (!is_valid(a)) return Status::kOutOfRange;
  BearingNavigationSettings settings;
  settings.blocks.burn_sigma = a.maneuver_sigma;
  settings.blocks.burn_sigma_relative = a.maneuver_sigma_relative;
  settings.blocks.relative_orbit.acceleration = {a.acceleration_psd, a.acceleration_psd_least, a.acceleration_psd_most};
  settings.blocks.brightness_offset.sigma = a.brightness_offset_m;
  settings.bearings.batch.bearings = a.batch_images;
  settings.blocks.boresight_a.sigma = a.bearing_bias;
  settings.bearings.batch.bias_sigma = a.bearing_bias;
  settings.bearings.model.centroid_noise_m = a.centroid_noise_m;
  return settings;
}

Result<pose::PoseCameraSettings> pose_camera_settings(const camera_configuration& c, const pose_configuration& p) {
  const Result<CalibratedCamera> camera = calibrated_camera(c);
  if (!camera.ok() || !has_valid_network(p) || !agree(c, p)) return Status::kOutOfRange;
  pose::PoseCameraSettings settings;
  settings.frame = camera.value().frame;
  settings.model = camera.value().model;
  settings.dark_level_dn = p.dark_level_dn;
  settings.noise_dn = p.noise_dn;
  settings.saturation_dn = camera.value().saturation_dn;
  const Result<pose::KeypointShape> shape = keypoint_shape(p);
  if (!shape.ok()) return shape.status();
  settings.shape = shape.value();
  return settings;
}

Result<KeypointNavigationSettings> keypoint_settings(const camera_configuration& c, const pose_configuration& p) {
  const Result<CalibratedCamera> camera = calibrated_camera(c);
  const Result<pose::PoseCameraSettings> network = pose_camera_settings(c, p);
  const Result<navigation::Inertia> inertia = inertia_of(p);
  if (!camera.ok() || !network.ok() || !inertia.ok() || !is_valid(p)) return Status::kOutOfRange;
  KeypointNavigationSettings settings;
  sources::KeypointSettings& keypoints = settings.keypoints;
  keypoints.camera = network.value();
  keypoints.R_camera_body = camera.value().R_camera_body;
  keypoints.sigma_scale = p.keypoint_sigma_scale;
  keypoints.sigma_floor_px = p.keypoint_floor_px;
  // Its boresight is known against the star tracker alone.
  keypoints.aiding.model = {.camera = 1, .optics = camera.value().model, .shape = network.value().shape};
  keypoints.aiding.start.min_images = p.start_images;
  keypoints.aiding.start.sigma_a_roe_m = vector(p.start_sigma_a_roe_m);
  keypoints.aiding.inertia = inertia.value();
  keypoints.aiding.camera_position_camera_m = camera.value().R_camera_body * camera.value().position_body_m;
  settings.blocks.burn_sigma = p.maneuver_sigma;
  settings.blocks.burn_sigma_relative = p.maneuver_sigma_relative;
  settings.blocks.relative_orbit.acceleration = {p.acceleration_psd, p.acceleration_psd_least, p.acceleration_psd_most};
  settings.blocks.attitude.inertia = inertia.value();
  settings.blocks.attitude.angular_acceleration.psd = p.angular_acceleration_psd;
  if (has_apriori(p)) {
    trunk::TargetApriori& apriori = settings.apriori.emplace();
    apriori.kind = trunk::TargetApriori::Kind::kMeanRoe;
    apriori.time = GpsTime{p.apriori_epoch_ns};
    apriori.mean_a_roe_m = vector(p.apriori_a_roe_m);
    apriori.sigma_a_roe_m = vector(p.apriori_sigma_a_roe_m);
  }
  return settings;
}

}  // namespace vbar::fsw::gnc
