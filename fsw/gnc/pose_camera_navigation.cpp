#include "fsw/gnc/pose_camera_navigation.h"

#include "fsw/gnc/camera_configuration.h"
#include "fsw/gnc/message_fields.h"
#include "fsw/navigation/propagation.h"
#include "fsw/orbit/rtn.h"
#include "fsw/orbit/sun.h"

namespace vbar::fsw::gnc {
namespace {

// Largest delay of an image with respect to its time tag.
constexpr Duration kLongestDelay = duration_of_seconds(600);

// After this number of consecutive images without the illuminated target, its estimated position is considered wrong.
constexpr int kUnseenBeforeLost = 12;
// 1 sigma, share of the distance: largest position uncertainty with which the crop is predicted.
constexpr double kKnownShare = 0.05;
constexpr double kEdge_s = 20.0;  // of the Earth's shadow

bool is_surely_lit(const orbit::CartesianState& target, const Vector3& sun_eci) {
  const Vector3 on_the_way = kEdge_s * target.velocity_eci;
  return navigation::is_sunlit(target.position_eci - on_the_way, sun_eci) &&
         navigation::is_sunlit(target.position_eci + on_the_way, sun_eci);
}

}  // namespace

void PoseCameraNavigation::configure(GpsTime now, Inbox& inbox, const orbit::EarthOrientation& earth) {
  inbox.keep_newest(inbox.camera_configurations(), now, camera_);
  inbox.keep_newest(inbox.pose_configurations(), now, pose_);
  if (!camera_ || !pose_) return;
  const auto network = pose_camera_settings(*camera_, *pose_);
  const auto navigation = pose_settings(*camera_, *pose_, earth);
  if (!network.ok() || !navigation.ok()) {
    inbox.count_bad_content();
    camera_.reset();
    pose_.reset();
    return;
  }
  network_.configure(network.value());
  static_cast<void>(filter_.configure(navigation.value()));  // validated with the settings
  R_camera_body_ = rotation(camera_->q_camera_body);
  camera_model_ = network.value().model;
  last_image_.reset();
}

void PoseCameraNavigation::update(GpsTime now, Inbox& inbox, navigation::GnssNavigation& own_orbit,
                                  std::span<const navigation::Burn> burns) {
  has_image_ = false;
  edit_status_ = navigation::PoseEditStatus::kNone;
  estimated_pose_.reset();
  const imaging::ImageAssembly& image = inbox.image();
  if (!camera_ || !pose_ || !image.has_image()) return;
  const bool is_timely = image.image_time() <= now && now - image.image_time() <= kLongestDelay &&
                         (!last_image_ || image.image_time() > *last_image_);
  if (!is_timely) {
    inbox.count_unusable_time();
    return;
  }
  take_image(image, own_orbit, burns);
}

void PoseCameraNavigation::take_image(const imaging::ImageAssembly& image, navigation::GnssNavigation& own_orbit,
                                      std::span<const navigation::Burn> burns) {
  const GpsTime time = image.image_time();
  has_image_ = true;
  tiles_missing_ = image.tiles_missing();
  last_image_ = time;
  own_orbit.update(time, burns);

  navigation::PoseEpoch epoch;
  epoch.time = time;
  epoch.sun_eci = orbit::sun_position_gcrf(time).normalized();
  epoch.servicer_gnss = servicer_at(time, own_orbit, burns);
  // Propagation to the time of the image, then prediction of the crop, then processing of the image.
  static_cast<void>(filter_.update(epoch, burns));
  epoch.R_camera_eci = R_camera_eci_at(time, own_orbit, epoch.servicer_gnss);
  if (epoch.R_camera_eci) estimated_pose_ = pose_of_estimate(*epoch.R_camera_eci);
  const pose::PoseSighting& sighting = network_.process(time, image.image_number(), image.view(), expected_position());
  watch_for_target(epoch);
  if (!epoch.R_camera_eci || sighting.status > pose::SightingStatus::kKeypoints) return;
  epoch.servicer_gnss.reset();  // already processed
  keypoints_ = widened(sighting.keypoints);
  epoch.keypoints = &keypoints_;
  epoch.pnp = sighting.pnp;
  edit_status_ = filter_.update(epoch, burns);
  estimated_pose_ = pose_of_estimate(*epoch.R_camera_eci);
}

/// Predicted crop, if the position is known well enough that the target fills the crop as in training.
std::optional<Vector3> PoseCameraNavigation::expected_position() const {
  if (!estimated_pose_) return std::nullopt;
  const Vector3& position = estimated_pose_->position_camera_m;
  const Matrix3 covariance = filter_.filter().position_covariance(filter_.servicer());
  return covariance.trace() <= kKnownShare * kKnownShare * position.squaredNorm() ? std::optional(position)
                                                                                  : std::nullopt;
}

/// A target that is illuminated and in the field of view is detected; if not, its estimated position is wrong.
void PoseCameraNavigation::watch_for_target(const navigation::PoseEpoch& epoch) {
  const pose::PoseSighting& sighting = network_.sighting();
  if (sighting.status <= pose::SightingStatus::kKeypoints) {
    unseen_in_a_row_ = 0;
    const auto direction = imaging::direction_of(camera_model_, sighting.region.centre_px);
    if (!epoch.R_camera_eci || !epoch.servicer_gnss || !direction.ok()) return;
    last_seen_rtn_ = orbit::R_rtn_eci(*epoch.servicer_gnss) * epoch.R_camera_eci->transpose() * direction.value();
    return;
  }
  const Result<orbit::CartesianState> target = filter_.target();
  if (!filter_.valid() || !target.ok() || !is_surely_lit(target.value(), epoch.sun_eci)) return;
  if (++unseen_in_a_row_ < kUnseenBeforeLost) return;
  unseen_in_a_row_ = 0;
  filter_.lose_target();
  estimated_pose_.reset();
}

/// The covariances of the network hold for images as in its training; other illumination may require larger ones.
pose::Keypoints PoseCameraNavigation::widened(pose::Keypoints keypoints) const {
  const double by = pose_->keypoint_sigma_scale * pose_->keypoint_sigma_scale;
  const double floor = pose_->keypoint_floor_px * pose_->keypoint_floor_px;
  for (pose::Keypoint& keypoint : keypoints) {
    keypoint.covariance_px2 = by * keypoint.covariance_px2 + floor * Matrix2::Identity();
  }
  return keypoints;
}

/// By the star tracker, or the commanded attitude if it provides none.
std::optional<Matrix3> PoseCameraNavigation::R_camera_eci_at(
    GpsTime time, const navigation::GnssNavigation& own_orbit,
    const std::optional<orbit::CartesianState>& servicer) const {
  if (const auto R_eci_body = own_orbit.R_eci_body_at(navigation::Receiver::kServicer, time)) {
    return Matrix3(R_camera_body_ * R_eci_body->transpose());
  }
  if (!pointing_ || !servicer) return std::nullopt;
  return Matrix3(R_camera_body_ * R_body_eci_of(*pointing_, time, *servicer));
}

std::optional<pose::TargetPose> PoseCameraNavigation::pose_of_estimate(const Matrix3& R_camera_eci) const {
  const Result<orbit::CartesianState> target = filter_.target();
  if (!filter_.valid() || !target.ok()) return std::nullopt;
  const Vector3 apart_eci = target.value().position_eci - filter_.servicer().position_eci;
  pose::TargetPose estimate;
  estimate.position_camera_m = R_camera_eci * apart_eci - filter_.settings().camera_position_camera_m;
  estimate.R_camera_body = R_camera_eci * filter_.R_eci_body();
  return estimate;
}

}  // namespace vbar::fsw::gnc
