#include "fsw/measurements/keypoints/keypoint_settings.h"

#include "fsw/math/symmetric_eigen.h"
#include "fsw/measurements/calibrated_camera.h"
#include "fsw/messaging/message_fields.h"

namespace vbar::fsw::measurements {
namespace {

/// kOutOfRange unless positive definite and no principal moment exceeds the sum of the other two.
Result<filter::Inertia> inertia_of(const target_model& t) {
  Matrix3 inertia;
  inertia << t.inertia_kgm2[0], t.inertia_kgm2[3], t.inertia_kgm2[4],  //
      t.inertia_kgm2[3], t.inertia_kgm2[1], t.inertia_kgm2[5],         //
      t.inertia_kgm2[4], t.inertia_kgm2[5], t.inertia_kgm2[2];
  const auto eigen = math::symmetric_eigen(inertia);
  if (!eigen.ok()) return Status::kOutOfRange;
  const Vector3& moments = eigen.value().values;  // increasing
  const bool is_body = moments(0) > 1e-6 && moments(2) < 1e7 && moments(2) <= 1.0001 * (moments(0) + moments(1));
  if (!is_body) return Status::kOutOfRange;
  return filter::inertia_of(inertia);
}

/// kOutOfRange if the points are nearly coincident or collinear, or too far from the origin for any target.
Result<pose::KeypointShape> keypoint_shape(const target_model& t) {
  pose::KeypointShape shape{};
  Matrix3 spread = Matrix3::Zero();
  for (std::size_t k = 0; k < shape.size(); ++k) {
    for (int axis = 0; axis < 3; ++axis) shape[k](axis) = t.keypoints_body_m[3 * k + static_cast<std::size_t>(axis)];
    if (!(shape[k].norm() < 100.0)) return Status::kOutOfRange;
    spread += shape[k] * shape[k].transpose();
  }
  const auto eigen = math::symmetric_eigen(spread);
  if (!eigen.ok() || !(eigen.value().values(1) > 1e-4)) return Status::kOutOfRange;
  return shape;
}

}  // namespace

bool is_valid(const target_model& model) {
  return keypoint_shape(model).ok() && inertia_of(model).ok() &&
         messaging::is_positive(model.angular_acceleration_psd, 1.0);
}

bool is_valid(const pose_configuration& p) {
  const Vector6 sigma_a_roe_m = messaging::vector(p.start_sigma_a_roe_m);
  return messaging::is_between(p.exposure_s, 0.0, messaging::kLongestExposure_s) &&
         messaging::is_positive(p.keypoint_sigma_scale, 100.0) &&
         messaging::is_between(p.keypoint_floor_px, 0.0, 100.0) && (sigma_a_roe_m.array() > 0.0).all() &&
         (sigma_a_roe_m.array() < 1e6).all() && p.start_images >= 1 &&
         p.start_images <= static_cast<std::int32_t>(measurements::PoseInitialiser::kMaxSamples);
}

Result<pose::PoseCameraSettings> pose_camera_settings(const camera_configuration& c, const target_model& target) {
  const Result<CalibratedCamera> camera = calibrated_camera(c);
  const Result<pose::KeypointShape> shape = keypoint_shape(target);
  if (!camera.ok() || !shape.ok()) return Status::kOutOfRange;
  pose::PoseCameraSettings settings;
  settings.frame = camera.value().frame;
  settings.model = camera.value().model;
  settings.dark_level_dn = c.dark_level_dn;
  settings.noise_dn = c.noise_dn;
  settings.saturation_dn = camera.value().saturation_dn;
  settings.shape = shape.value();
  return settings;
}

Result<KeypointCameraSettings> keypoint_camera_settings(std::size_t unit, const camera_configuration& c,
                                                        const target_model& target,
                                                        const pose_configuration& configuration) {
  const Result<CalibratedCamera> camera = calibrated_camera(c);
  const Result<pose::PoseCameraSettings> network = pose_camera_settings(c, target);
  if (!camera.ok() || !network.ok() || !is_valid(configuration)) return Status::kOutOfRange;
  KeypointCameraSettings settings;
  settings.network = network.value();
  settings.camera.model = {.camera = unit, .optics = camera.value().model, .shape = network.value().shape};
  settings.camera.position_camera_m = camera.value().R_camera_body * camera.value().position_body_m;
  settings.R_camera_body = camera.value().R_camera_body;
  settings.sigma_scale = configuration.keypoint_sigma_scale;
  settings.sigma_floor_px = configuration.keypoint_floor_px;
  return settings;
}

Result<KeypointAidingSettings> keypoint_aiding_settings(const target_model& target,
                                                        const pose_configuration& configuration) {
  const Result<filter::Inertia> inertia = inertia_of(target);
  if (!inertia.ok() || !is_valid(configuration)) return Status::kOutOfRange;
  KeypointAidingSettings settings;
  settings.inertia = inertia.value();
  settings.start.min_images = configuration.start_images;
  settings.start.sigma_a_roe_m = messaging::vector(configuration.start_sigma_a_roe_m);
  return settings;
}

Result<filter::TargetAttitudeSettings> attitude_settings(const target_model& target) {
  const Result<filter::Inertia> inertia = inertia_of(target);
  if (!inertia.ok()) return inertia.status();
  filter::TargetAttitudeSettings settings;
  settings.inertia = inertia.value();
  settings.angular_acceleration.psd = target.angular_acceleration_psd;
  return settings;
}

}  // namespace vbar::fsw::measurements
