// Telemetry of an image of the pose network.

#include "fsw/measurements/keypoints/keypoint_source.h"
#include "fsw/messaging/message_fields.h"

namespace vbar::fsw::measurements {
namespace {

using messaging::copy;

// The last of each list stands for all: the lists of vbar.lcm are those of the code.
static_assert(static_cast<int>(pose::SightingStatus::kInvalid) == telemetry_pose::kStatusInvalid);
static_assert(static_cast<int>(KeypointEditStatus::kStart) == telemetry_pose::kEditStart);

/// Values of telemetry_pose.keypoint_fate.
std::int8_t keypoint_fate(const pose::Keypoint& seen, const KeypointUpdate& update) {
  if (update.accepted) return telemetry_pose::kKeypointUsed;
  if (update.is_usable) return telemetry_pose::kKeypointRejected;
  return seen.is_usable ? telemetry_pose::kKeypointWithoutFilter : telemetry_pose::kKeypointUnusable;
}

void copy_sighting(const pose::PoseSighting& sighting, telemetry_pose& message) {
  message.image = sighting.image;
  message.status = static_cast<std::int8_t>(sighting.status);
  message.region_is_predicted = sighting.region_is_predicted ? 1 : 0;
  message.region_px[0] = sighting.region.centre_px.x();
  message.region_px[1] = sighting.region.centre_px.y();
  message.region_px[2] = sighting.region.side_px;
  for (std::size_t k = 0; k < sighting.keypoints.size(); ++k) {
    const pose::Keypoint& keypoint = sighting.keypoints[k];
    message.x_px[k] = static_cast<float>(keypoint.pixel.x());
    message.y_px[k] = static_cast<float>(keypoint.pixel.y());
    message.covariance_px2[3 * k] = static_cast<float>(keypoint.covariance_px2(0, 0));
    message.covariance_px2[3 * k + 1] = static_cast<float>(keypoint.covariance_px2(1, 0));
    message.covariance_px2[3 * k + 2] = static_cast<float>(keypoint.covariance_px2(1, 1));
    message.peak[k] = static_cast<float>(keypoint.peak);
  }
  if (!sighting.pnp) return;
  message.pnp_inliers = static_cast<std::int8_t>(sighting.pnp->inliers);
  messaging::copy_rotation(sighting.pnp->pose.R_camera_body, message.pnp_q_camera_body);
  copy(sighting.pnp->pose.position_camera_m, message.pnp_position_camera_m);
  message.pnp_mean_square = sighting.pnp->mean_square;
}

void copy_counters(const KeypointCounters& counters, telemetry_pose& message) {
  message.images_used = counters.images_used;
  message.images_refused = counters.images_rejected;
  message.keypoints_used = counters.keypoints_used;
  message.keypoints_refused = counters.keypoints_rejected;
  message.attitude_restarts = counters.attitudes_reset;
  message.restarts = counters.restarts;
}

void copy_estimate(const KeypointImage& image, const filter::RelativeNavigationFilter& filter,
                   telemetry_pose& message) {
  if (!image.R_camera_eci) return;
  const Result<Vector3> position = target_position_camera(image.camera, *image.R_camera_eci, filter);
  if (!position.ok()) return;
  copy(position.value(), message.position_camera_m);
  Matrix3 R_camera_body = *image.R_camera_eci;
  if (filter.has_attitude()) {
    const filter::AttitudeState& attitude = filter.attitude().state();
    R_camera_body = *image.R_camera_eci * attitude.q_eci_body.toRotationMatrix();
    message.has_attitude = 1;
    copy(attitude.rate_body, message.rate_body);
    messaging::copy_lower_triangle(filter::attitude_covariance(filter.estimate()), message.covariance_attitude);
  }
  messaging::copy_rotation(R_camera_body, message.q_camera_body);
  copy(filter.a_roe_m(), message.a_roe_osculating_m);
  messaging::copy_lower_triangle(filter.a_roe_covariance_m2(), message.covariance_a_roe);
}

}  // namespace

/// Copies the estimate of the filter after the image.
telemetry_pose KeypointSource::report_of(const KeypointImage& image, KeypointEditStatus edit_status, int tiles_missing,
                                         const filter::RelativeNavigationFilter& filter) const {
  const pose::PoseSighting& sighting = network_.sighting();
  const KeypointsUpdate& update = aiding_.last_update();
  telemetry_pose message{};
  copy_sighting(sighting, message);
  for (std::size_t k = 0; k < sighting.keypoints.size(); ++k) {
    message.keypoint_fate[k] = keypoint_fate(sighting.keypoints[k], update.keypoints[k]);
  }
  message.fate = static_cast<std::int8_t>(edit_status);
  message.filter_runs = filter.solution_status() == filter::SolutionStatus::kEstimated ? 1 : 0;
  message.tiles_missing = static_cast<std::int16_t>(tiles_missing);
  copy_estimate(image, filter, message);
  message.nis = update.nis;
  message.nis_degrees = 2 * update.used;
  message.acceleration_psd = filter.relative_orbit().noise().psd();
  copy_counters(aiding_.counters(), message);
  return message;
}

void KeypointSource::report(const Telemetry& telemetry) const {
  for (std::size_t unit = 0; unit < cameras_.size(); ++unit) {
    const Camera& camera = cameras_[unit];
    if (!camera.report || !camera.last_image) continue;
    telemetry_pose message = *camera.report;
    message.step = telemetry.step;
    message.tiles_refused = telemetry.inbox.image(unit).counts().tiles_refused;
    telemetry.outbox.send(*camera.last_image, message, static_cast<std::uint8_t>(unit));
  }
}

}  // namespace vbar::fsw::measurements
