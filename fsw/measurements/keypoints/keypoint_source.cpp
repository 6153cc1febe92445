#include "fsw/measurements/keypoints/keypoint_source.h"

#include "fsw/math/math.h"
#include "fsw/orbit/rtn.h"
#include "fsw/orbit/sun.h"
#include "fsw/vision/imaging/camera_model.h"

namespace vbar::fsw::measurements {
namespace {

// 1 sigma, share of the distance: largest position uncertainty with which the crop is predicted, so that the target
// fills it as in training.
constexpr double kKnownShare = 0.05;

/// For the crop: only if the position is known well enough.
std::optional<Vector3> predicted_position_camera(const KeypointImage& image,
                                                 const filter::RelativeNavigationFilter& filter) {
  if (!image.R_camera_eci) return std::nullopt;
  const Result<Vector3> position = target_position_camera(image.camera, *image.R_camera_eci, filter);
  if (!position.ok()) return std::nullopt;
  const double largest_variance = kKnownShare * kKnownShare * position.value().squaredNorm();
  if (!(filter.position_covariance_eci().trace() <= largest_variance)) return std::nullopt;
  return position.value();
}

/// The covariances of the network hold for images as in its training; other illumination may require larger ones.
pose::Keypoints widened(pose::Keypoints keypoints, const KeypointCameraSettings& camera) {
  const double scale = camera.sigma_scale * camera.sigma_scale;
  const double floor = camera.sigma_floor_px * camera.sigma_floor_px;
  for (pose::Keypoint& keypoint : keypoints) {
    keypoint.covariance_px2 = scale * keypoint.covariance_px2 + floor * Matrix2::Identity();
  }
  return keypoints;
}

/// The images of two cameras may have one number: it is unique together with the unit.
std::uint32_t record_number(std::int32_t image, std::size_t unit) {
  return static_cast<std::uint32_t>(image) * static_cast<std::uint32_t>(packets::kCameras) +
         static_cast<std::uint32_t>(unit);
}
std::size_t unit_of(const Record& record) {
  return record.number % packets::kCameras;
}

}  // namespace

Result<Vector3> target_position_camera(const KeypointCamera& camera, const Matrix3& R_camera_eci,
                                       const filter::RelativeNavigationFilter& filter) {
  const Result<orbit::CartesianState> target = filter.target();
  if (!target.ok()) return target.status();
  const Vector3 apart_eci = target.value().position_eci - filter.servicer().position_eci;
  return Vector3(R_camera_eci * apart_eci - camera.position_camera_m);
}

bool KeypointSource::configure(const Configuration& configuration) {
  const messaging::Telecommands& telecommands = configuration.telecommands;
  const auto* target = telecommands.in_force<target_model>();
  if (target == nullptr) return false;
  bool is_new = telecommands.is_new<target_model>();
  const pose_configuration* first = nullptr;
  for (std::size_t unit = 0; unit < cameras_.size(); ++unit) {
    const auto* camera = telecommands.in_force<camera_configuration>(unit);
    const auto* pose = telecommands.in_force<pose_configuration>(unit);
    if (camera == nullptr || pose == nullptr) continue;
    const auto settings = keypoint_camera_settings(unit, *camera, *target, *pose);
    if (!settings.ok()) return false;
    cameras_[unit].settings = settings.value();
    cameras_[unit].exposures = two_exposures(telecommands, unit);
    if (first == nullptr) first = pose;
    is_new = is_new || telecommands.is_new<camera_configuration>(unit) || telecommands.is_new<pose_configuration>(unit);
  }
  if (first == nullptr) return false;
  const auto aiding = keypoint_aiding_settings(*target, *first);
  const auto attitude = attitude_settings(*target);
  if (!aiding.ok() || !attitude.ok()) return false;
  configuration.settings.attitude = attitude.value();
  if (is_new) aiding_.configure(aiding.value());
  return true;
}

void KeypointSource::collect(Context& context, RecordFiler records) {
  aiding_.forget_verdict();
  for (std::size_t unit = 0; unit < cameras_.size(); ++unit) {
    Camera& camera = cameras_[unit];
    camera.report.reset();
    const imaging::ImageAssembly& image = context.inbox.image(unit);
    if (!camera.settings || !image.has_image()) continue;
    if (camera.exposures && !camera.exposures->is_for_keypoints(image.exposure_s())) camera.scheduler.take_bearing();
    if (!shows_keypoints(camera, image.exposure_s())) continue;
    const GpsTime time = image.image_time();
    const bool is_timely =
        time <= context.now && context.now - time <= kLongestDelay && (!camera.last_image || time > *camera.last_image);
    if (!is_timely || records.file(time, record_number(image.image_number(), unit)) != Status::kOk) {
      context.inbox.count_unusable_time();
    }
  }
}

/// A camera for nothing else may always show them.
bool KeypointSource::shows_keypoints(const Camera& camera, double exposure_s) {
  if (!camera.exposures) return true;
  return camera.resolution == Resolution::kResolved && camera.exposures->is_for_keypoints(exposure_s);
}

void KeypointSource::watch(GpsTime now, filter::RelativeNavigationFilter& filter) {
  for (Camera& camera : cameras_) {
    if (camera.exposures) camera.resolution = resolution_of(*camera.settings, filter, camera.resolution);
  }
  aiding_.check_age(now);
}

/// A target that fills the image of this camera is resolved by another: stars are not expected beside it.
std::optional<double> KeypointSource::wanted_exposure_s(std::size_t camera) const {
  const Camera& chosen = cameras_[camera];
  if (!chosen.exposures) return std::nullopt;
  const bool is_resolved = chosen.resolution == Resolution::kResolved || chosen.resolution == Resolution::kTooLarge;
  const bool is_for_keypoints = aid().is_on() && is_resolved && !chosen.scheduler.is_bearing_due();
  return is_for_keypoints ? chosen.exposures->keypoints_s : chosen.exposures->bearings_s;
}

void KeypointSource::process_record(const Record& record, Context& context, filter::RelativeNavigationFilter& filter) {
  const std::size_t unit = unit_of(record);
  Camera& camera = cameras_[unit];
  const imaging::ImageAssembly& frame = context.inbox.image(unit);
  const bool is_there = camera.settings && frame.has_image() && frame.image_time() == record.time;
  if (!is_there) return context.inbox.count_unusable_time();
  camera.last_image = record.time;
  last_image_ = record.time;

  const KeypointCameraSettings& settings = *camera.settings;
  KeypointImage image;
  image.time = record.time;
  image.camera = settings.camera;
  image.sun_eci = orbit::sun_position_gcrf(record.time).normalized();
  image.R_camera_eci = R_camera_eci_at(record.time, settings.R_camera_body, context.platform, filter);
  const Result<Vector3> position =
      image.R_camera_eci ? target_position_camera(image.camera, *image.R_camera_eci, filter) : Status::kNotReady;
  std::optional<double> scale;
  if (position.ok()) scale = image_scale(settings, math::sqrt(position.value().squaredNorm()));
  if (scale) image.camera.model.lasting_stretch_scale = lasting_stretch_scale(*scale);
  network_.configure(settings.network);
  const pose::PoseSighting& sighting =
      network_.process(record.time, frame.image_number(), frame.view(),
                       aiding_.searches() ? std::nullopt : predicted_position_camera(image, filter));
  if (sighting.status <= pose::SightingStatus::kKeypointsOnly) {
    remember_direction(settings, image.R_camera_eci, filter);
    keypoints_ = widened(sighting.keypoints, settings);
    image.keypoints = &keypoints_;
    image.pnp = sighting.pnp;
  }
  const KeypointEditStatus edit_status = aiding_.process(image, filter);
  const bool serves = aid().state() == AidState::kAiding || aid().state() == AidState::kStarting;
  camera.scheduler.take_keypoints(scale, serves);
  camera.report = report_of(image, edit_status, frame.tiles_missing(), filter);
}

/// The attitude and the errors of keypoints and mounts end with their only source; the orbit stays.
void KeypointSource::stop(GpsTime now, filter::RelativeNavigationFilter& filter) {
  filter.deactivate_attitude();
  filter::deactivate_block<CameraMounts>(filter.estimate());
  for (Camera& camera : cameras_) camera.report.reset();
  aid().go_to(AidState::kOff, now);
}

/// Returns the attitude of the star tracker, or the commanded attitude if it provides none.
std::optional<Matrix3> KeypointSource::R_camera_eci_at(GpsTime time, const Matrix3& R_camera_body,
                                                       const Platform& platform,
                                                       const filter::RelativeNavigationFilter& filter) {
  if (const auto R_eci_body = platform.servicer_attitude.R_eci_body_at(time)) {
    return Matrix3(R_camera_body * R_eci_body->transpose());
  }
  if (!platform.pointing || !filter.absolute_orbit().started()) return std::nullopt;
  return Matrix3(R_camera_body * R_body_eci_of(*platform.pointing, time, filter.servicer()));
}

void KeypointSource::remember_direction(const KeypointCameraSettings& camera,
                                        const std::optional<Matrix3>& R_camera_eci,
                                        const filter::RelativeNavigationFilter& filter) {
  const auto direction = imaging::direction_of(camera.network.model, network_.sighting().region.centre_px);
  if (!R_camera_eci || !filter.absolute_orbit().started() || !direction.ok()) return;
  last_seen_rtn_ = orbit::R_rtn_eci(filter.servicer()) * R_camera_eci->transpose() * direction.value();
}

}  // namespace vbar::fsw::measurements
