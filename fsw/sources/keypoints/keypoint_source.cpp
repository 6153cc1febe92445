#include "fsw/sources/keypoints/keypoint_source.h"

#include "fsw/imaging/camera_model.h"
#include "fsw/orbit/rtn.h"
#include "fsw/orbit/sun.h"

namespace vbar::fsw::sources {
namespace {

// 1 sigma, share of the distance: largest position uncertainty with which the crop is predicted, so that the target
// fills it as in training.
constexpr double kKnownShare = 0.05;

}  // namespace

void KeypointSource::configure(const KeypointSettings& settings) {
  settings_ = settings;
  network_.configure(settings.camera);
  aiding_.configure(settings.aiding);
}

void KeypointSource::collect(Context& context, RecordFiler records) {
  has_image_ = false;
  edit_status_ = KeypointEditStatus::kNone;
  const imaging::ImageAssembly& image = context.inbox.image();
  if (!image.has_image()) return;
  const bool is_timely = image.image_time() <= context.now && context.now - image.image_time() <= kLongestDelay &&
                         (!last_image_ || image.image_time() > *last_image_);
  if (!is_timely || records.file(image.image_time(), static_cast<std::uint32_t>(image.image_number())) != Status::kOk) {
    context.inbox.count_unusable_time();
  }
}

void KeypointSource::fold(const Record& record, Context& context, trunk::Trunk& trunk) {
  const imaging::ImageAssembly& frame = context.inbox.image();
  if (!frame.has_image() || frame.image_time() != record.time) return context.inbox.count_unusable_time();
  has_image_ = true;
  tiles_missing_ = frame.tiles_missing();
  last_image_ = record.time;

  KeypointImage image;
  image.time = record.time;
  image.sun_eci = orbit::sun_position_gcrf(record.time).normalized();
  image.R_camera_eci = R_camera_eci_at(record.time, context.platform, trunk);
  const pose::PoseSighting& sighting = network_.process(record.time, frame.image_number(), frame.view(),
                                                        predicted_position_camera(image.R_camera_eci, trunk));
  if (sighting.status <= pose::SightingStatus::kKeypoints) {
    remember_direction(image.R_camera_eci, trunk);
    keypoints_ = widened(sighting.keypoints);
    image.keypoints = &keypoints_;
    image.pnp = sighting.pnp;
  }
  edit_status_ = aiding_.process(image, trunk);
  keep_estimate(image.R_camera_eci, trunk);
}

/// The attitude and the errors of keypoints end with their only source; the orbit stays.
void KeypointSource::stop(GpsTime now, trunk::Trunk& trunk) {
  trunk.rest_attitude();
  has_image_ = false;
  estimated_.reset();
  aid().go_to(AidState::kOff, now);
}

/// By the star tracker, or the commanded attitude if it provides none.
std::optional<Matrix3> KeypointSource::R_camera_eci_at(GpsTime time, const Platform& platform,
                                                       const trunk::Trunk& trunk) const {
  if (const auto R_eci_body = platform.servicer_attitude.R_eci_body_at(time)) {
    return Matrix3(settings_.R_camera_body * R_eci_body->transpose());
  }
  if (!platform.pointing || !trunk.own_orbit().started()) return std::nullopt;
  return Matrix3(settings_.R_camera_body * R_body_eci_of(*platform.pointing, time, trunk.servicer()));
}

std::optional<Vector3> KeypointSource::target_position_camera(const Matrix3& R_camera_eci,
                                                              const trunk::Trunk& trunk) const {
  const Result<orbit::CartesianState> target = trunk.target();
  if (!target.ok()) return std::nullopt;
  const Vector3 apart_eci = target.value().position_eci - trunk.servicer().position_eci;
  return Vector3(R_camera_eci * apart_eci - settings_.aiding.camera_position_camera_m);
}

/// For the crop: only if the position is known well enough.
std::optional<Vector3> KeypointSource::predicted_position_camera(const std::optional<Matrix3>& R_camera_eci,
                                                                 const trunk::Trunk& trunk) const {
  if (!R_camera_eci) return std::nullopt;
  const auto position = target_position_camera(*R_camera_eci, trunk);
  if (!position) return std::nullopt;
  const double largest_variance = kKnownShare * kKnownShare * position->squaredNorm();
  return trunk.position_covariance_eci().trace() <= largest_variance ? position : std::nullopt;
}

void KeypointSource::remember_direction(const std::optional<Matrix3>& R_camera_eci, const trunk::Trunk& trunk) {
  const auto direction = imaging::direction_of(settings_.camera.model, network_.sighting().region.centre_px);
  if (!R_camera_eci || !trunk.own_orbit().started() || !direction.ok()) return;
  last_seen_rtn_ = orbit::R_rtn_eci(trunk.servicer()) * R_camera_eci->transpose() * direction.value();
}

/// The covariances of the network hold for images as in its training; other illumination may require larger ones.
pose::Keypoints KeypointSource::widened(pose::Keypoints keypoints) const {
  const double scale = settings_.sigma_scale * settings_.sigma_scale;
  const double floor = settings_.sigma_floor_px * settings_.sigma_floor_px;
  for (pose::Keypoint& keypoint : keypoints) {
    keypoint.covariance_px2 = scale * keypoint.covariance_px2 + floor * Matrix2::Identity();
  }
  return keypoints;
}

void KeypointSource::keep_estimate(const std::optional<Matrix3>& R_camera_eci, const trunk::Trunk& trunk) {
  estimated_.reset();
  if (!R_camera_eci) return;
  const auto position = target_position_camera(*R_camera_eci, trunk);
  if (!position) return;
  Estimated estimated;
  estimated.pose.position_camera_m = *position;
  estimated.pose.R_camera_body = *R_camera_eci;
  estimated.has_attitude = trunk.has_attitude();
  if (estimated.has_attitude) {
    const navigation::AttitudeState& attitude = trunk.attitude().state();
    estimated.pose.R_camera_body = *R_camera_eci * attitude.q_eci_body.toRotationMatrix();
    estimated.rate_body = attitude.rate_body;
    estimated.attitude_covariance = trunk::attitude_covariance(trunk.estimate());
  }
  estimated.a_roe_m = trunk.a_roe_m();
  estimated.a_roe_covariance_m2 = trunk.a_roe_covariance_m2();
  estimated_ = estimated;
}

}  // namespace vbar::fsw::sources
