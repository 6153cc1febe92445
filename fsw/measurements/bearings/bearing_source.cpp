#include "fsw/measurements/bearings/bearing_source.h"

#include "fsw/math/math.h"
#include "fsw/measurements/calibrated_camera.h"
#include "fsw/messaging/message_fields.h"
#include "fsw/orbit/rtn.h"
#include "fsw/orbit/sun.h"

namespace vbar::fsw::measurements {

bool is_valid(const angles_only_configuration& a) {
  return messaging::is_between(a.exposure_s, 0.0, messaging::kLongestExposure_s) &&
         messaging::is_between(a.detection_sigmas, 1.0, 30.0) &&
         messaging::is_between(a.centroid_floor_px, 0.0, 10.0) &&
         messaging::is_positive(a.pointing_tolerance, stars::kLargestTolerance) &&
         messaging::is_between(a.brightness_offset_m, 0.0, 100.0) &&
         messaging::is_between(a.centroid_noise_m, 0.0, 100.0) && messaging::is_positive(a.bearing_bias, 0.1) &&
         a.batch_images >= 10 && a.batch_images <= static_cast<std::int32_t>(measurements::BearingBatch::kCapacity);
}

Result<target_tracking::CameraSettings> camera_settings(const camera_configuration& c,
                                                        const angles_only_configuration& a) {
  const Result<CalibratedCamera> camera = calibrated_camera(c);
  if (!camera.ok() || !is_valid(a)) return Status::kOutOfRange;
  target_tracking::CameraSettings settings;
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

namespace {

using messaging::copy;

// The last of each list stands for all: the lists of vbar.lcm are those of the code.
static_assert(static_cast<int>(target_tracking::SightingStatus::kAmbiguous) == telemetry_image::kStatusAmbiguous);
static_assert(static_cast<int>(target_tracking::StarMethod::kPredicted) == telemetry_image::kStarMethodPrediction);
static_assert(static_cast<int>(target_tracking::ObjectKind::kHotPixel) == telemetry_objects::kKindHotPixel);
static_assert(static_cast<int>(BearingEditStatus::kBatch) == telemetry_image::kEditBatch);

// Stars that fit an attitude of three components with a contradiction left to see.
constexpr int kMinStars = 5;

// Of a centroid's scatter, the part that the rotation of the target does not average: 0.43 with a rotation from image
// to image (Monte Carlo of target_tracking/bearing.h), more with a slow one.
constexpr double kLastingShare = 0.625;

// The displacement of the centroid by earthlight over that by sunlight (target_tracking/bearing.h): always towards the
// Earth, and as uncertain as it is large.
constexpr double kEarthlightShare = 0.2;

// Images in one direction, enough to establish a track there.
constexpr int kImagesInTurn = 10;

constexpr double kSpeedOfLight = 299792458.0;  // m/s

// The target is visible when it is illuminated. Near an edge of the shadow it may or may not be.
constexpr double kLitProbability = 0.95;
constexpr double kEdgeProbability = 0.5;
// The penumbra extends 14 km to either side of the shadow of a sphere where the orbit crosses it; the Earth's polar
// radius is 21 km smaller.
constexpr double kEdge_m = 35e3;

double detection_probability(const orbit::CartesianState& target, const Vector3& sun_eci) {
  const Vector3 edge = kEdge_m * target.position_eci.normalized();
  if (filter::is_sunlit(target.position_eci - edge, sun_eci)) return kLitProbability;
  return filter::is_sunlit(target.position_eci + edge, sun_eci) ? kEdgeProbability : 0.0;
}

}  // namespace

bool BearingSource::configure(const Configuration& configuration) {
  const messaging::Telecommands& telecommands = configuration.telecommands;
  for (std::size_t unit = 0; unit < packets::kCameras; ++unit) {
    const auto* camera = telecommands.in_force<camera_configuration>(unit);
    const auto* angles_only = telecommands.in_force<angles_only_configuration>(unit);
    if (camera == nullptr || angles_only == nullptr) continue;
    const auto optics = camera_settings(*camera, *angles_only);
    const auto bearings = bearing_settings(*angles_only);
    if (!optics.ok() || !bearings.ok()) return false;
    configuration.settings.processes.of<BrightnessOffset>().sigma = angles_only->brightness_offset_m;
    estimation::GaussMarkov& earthlight = configuration.settings.processes.of<EarthlightOffset>();
    earthlight.mean = kEarthlightShare * angles_only->brightness_offset_m;
    earthlight.sigma = earthlight.mean;
    configuration.settings.processes.of<CentroidWander>().sigma = kLastingShare * angles_only->centroid_noise_m;
    configuration.settings.processes.of<BearingBias>().sigma = angles_only->bearing_bias;
    aiding_.configure(bearings.value());
    const bool is_new = unit != camera_ || telecommands.is_new<camera_configuration>(unit) ||
                        telecommands.is_new<angles_only_configuration>(unit);
    camera_ = unit;
    exposures_ = two_exposures(telecommands, unit);
    if (is_new) tracking_.configure(optics.value());
    return true;
  }
  return false;
}

void BearingSource::collect(Context& context, RecordFiler records) {
  has_image_ = false;
  edit_status_ = BearingEditStatus::kNone;
  const imaging::ImageAssembly& image = context.inbox.image(camera_);
  if (!aid().is_on() || !image.has_image()) return;
  if (exposures_ && exposures_->is_for_keypoints(image.exposure_s())) return;
  const bool is_timely = image.image_time() <= context.now && context.now - image.image_time() <= kLongestDelay &&
                         (!last_image_ || image.image_time() > *last_image_);
  if (!is_timely || records.file(image.image_time(), static_cast<std::uint32_t>(image.image_number())) != Status::kOk) {
    context.inbox.count_unusable_time();
  }
}

std::optional<GpsTime> BearingSource::pending_since(GpsTime /*now*/) const {
  return std::nullopt;
}

void BearingSource::process_record(const Record& record, Context& context, filter::RelativeNavigationFilter& filter) {
  const imaging::ImageAssembly& image = context.inbox.image(camera_);
  if (!image.has_image() || image.image_time() != record.time) return context.inbox.count_unusable_time();
  has_image_ = true;
  const Vector3 sun_eci = orbit::sun_position_gcrf(record.time).normalized();
  const target_tracking::ImagePriors priors = priors_of(context, sun_eci, filter);
  const target_tracking::Sighting& sighting =
      tracking_.process({record.time, image.image_number(), image.tiles_missing(), image.view()}, priors);
  if (sighting.status == target_tracking::SightingStatus::kNoStars) ++images_without_stars_;
  std::optional<target_tracking::BearingMeasurement> bearing;
  if (sighting.status == target_tracking::SightingStatus::kBearing) bearing = sighting.bearing;
  if (sighting.is_as_kept) {
    aiding_.return_to_kept(record.time, filter);
    search_ = {};
  }
  edit_status_ = aiding_.process(record.time, bearing, sun_eci, filter);
  note_search(priors, filter);
  a_roe_m_ = filter.a_roe_m();
  a_roe_covariance_m2_ = filter.a_roe_covariance_m2();
  last_image_ = record.time;
}

/// Stars in the image show that the target would have been in it. Another source that determines the orbit ends a
/// search.
void BearingSource::note_search(const target_tracking::ImagePriors& priors,
                                const filter::RelativeNavigationFilter& filter) {
  const target_tracking::Sighting& sighting = tracking_.sighting();
  const bool is_expected = priors.target && priors.detection_probability > kEdgeProbability &&
                           sighting.star_method != target_tracking::StarMethod::kNone;
  const bool is_used = edit_status_ == BearingEditStatus::kFilter || edit_status_ == BearingEditStatus::kBatch ||
                       filter.is_confirmed_by_others(BearingAiding::kSource);
  search_.note(is_expected, sighting.target >= 0, is_used);
}

Pointing BearingSource::searched(const Pointing& to_target) const {
  const Vector2 offset = search_.scan_offset();
  Pointing pointing = to_target;
  if (kept_direction_rtn_ && (images_with_kept_ / kImagesInTurn) % 2 == 1) {
    pointing.boresight_rtn = *kept_direction_rtn_;
    return pointing;
  }
  if (offset.squaredNorm() == 0.0) return pointing;
  pointing.boresight_rtn = (pointing.boresight_rtn + Vector3(offset.x(), 0.0, offset.y())).normalized();
  return pointing;
}

target_tracking::ImagePriors BearingSource::priors_of(const Context& context, const Vector3& sun_eci,
                                                      const filter::RelativeNavigationFilter& filter) {
  const GpsTime time = filter.epoch();
  target_tracking::ImagePriors priors;
  priors.is_orbit_known = filter.has_relative();
  if (!priors.is_orbit_known) return priors;
  priors.servicer = filter.servicer();
  priors.velocity_over_c_eci = orbit::earth_velocity_over_c_gcrf(time) + priors.servicer.velocity_eci / kSpeedOfLight;
  Matrix3 R_body_eci = Matrix3::Identity();
  const auto& pointing = context.platform.pointing;
  if (pointing) {
    R_body_eci = R_body_eci_of(*pointing, time, priors.servicer);
    priors.R_camera_eci = tracking_.settings().R_camera_body * R_body_eci;
  }
  Vector3 camera_rtn = Vector3::Zero();
  if (pointing) {
    const Vector3 camera_eci = R_body_eci.transpose() * tracking_.settings().position_body_m;
    camera_rtn = orbit::R_rtn_eci(priors.servicer) * camera_eci;
  }
  const auto prediction_of = [&](const orbit::CartesianState& target, const Matrix6& covariance_rtn) {
    orbit::RelativeState relative = orbit::relative_state_rtn(priors.servicer, target);
    relative.position_rtn -= camera_rtn;
    return target_tracking::prediction_of(relative, covariance_rtn);
  };
  if (const Result<orbit::CartesianState> target = filter.target(); target.ok()) {
    const auto prediction = prediction_of(target.value(), filter::covariance_rtn(filter.estimate(), priors.servicer));
    if (prediction.ok()) {
      const double radius = math::sqrt(priors.servicer.position_eci.squaredNorm());
      const double rate = math::sqrt(priors.servicer.velocity_eci.squaredNorm()) / radius;
      priors.target = search_.widened(prediction.value(), rate);
    }
    priors.is_search = search_.is_widened();
    priors.detection_probability = detection_probability(target.value(), sun_eci);
  }
  const KeptOrbit& kept = aiding_.kept_at_epoch(filter);
  kept_direction_rtn_.reset();
  images_with_kept_ = kept.is_kept() ? images_with_kept_ + 1 : 0;
  if (const Result<orbit::CartesianState> target = kept.target(priors.servicer); target.ok()) {
    kept_direction_rtn_ = orbit::relative_state_rtn(priors.servicer, target.value()).position_rtn.normalized();
    const auto prediction =
        prediction_of(target.value(), filter::covariance_rtn(kept.roe(), kept.covariance(), priors.servicer));
    if (prediction.ok()) priors.kept = prediction.value();
  }
  std::size_t count = 0;
  for (const filter::Impulse& impulse : filter.impulses()) {
    if (!last_image_ || impulse.time < *last_image_ || impulse.time >= time) continue;
    burns_since_image_[count++] = {impulse.time, impulse.dv_rtn, filter.settings().burn_sigma};
  }
  priors.burns = std::span(burns_since_image_).first(count);
  return priors;
}

std::optional<BearingSource::StarAttitude> BearingSource::star_attitude() const {
  const target_tracking::Sighting& sighting = tracking_.sighting();
  if (!has_image_ || sighting.star_method == target_tracking::StarMethod::kNone || sighting.stars < kMinStars) {
    return std::nullopt;
  }
  return StarAttitude{sighting.time, sighting.R_camera_eci.transpose() * tracking_.settings().R_camera_body};
}

void BearingSource::report(const Telemetry& telemetry) const {
  if (!has_image_) return;
  report_image(telemetry);
  report_objects(telemetry);
}

void BearingSource::report_image(const Telemetry& telemetry) const {
  const target_tracking::Sighting& sighting = tracking_.sighting();
  telemetry_image message{};
  message.step = telemetry.step;
  message.image = sighting.image;
  message.status = static_cast<std::int8_t>(sighting.status);
  message.star_method = static_cast<std::int8_t>(sighting.star_method);
  message.tiles_missing = static_cast<std::int16_t>(sighting.tiles_missing);
  message.objects = static_cast<std::int16_t>(sighting.objects);
  message.stars = static_cast<std::int16_t>(sighting.stars);
  message.hypotheses = static_cast<std::int16_t>(sighting.hypotheses);
  message.target_object = static_cast<std::int16_t>(sighting.target);
  message.background_dn = sighting.background_dn;
  message.noise_dn = sighting.noise_dn;
  messaging::copy_rotation(sighting.R_camera_eci.transpose(), message.q_eci_camera);
  message.attitude_sigma = sighting.attitude_sigma;
  copy(sighting.bearing.direction_eci, message.bearing_eci);
  message.bearing_sigma = sighting.bearing.sigma;
  const BearingUpdate& update = aiding_.last_update();
  for (int axis = 0; axis < 2; ++axis) {
    message.prefit[axis] = update.prefit(axis);
    message.postfit[axis] = update.postfit(axis);
  }
  message.nis = update.nis;
  message.fate = static_cast<std::int8_t>(edit_status_);
  message.filter_runs = telemetry.filter.solution_status() == filter::SolutionStatus::kEstimated ? 1 : 0;
  copy(a_roe_m_, message.a_roe_osculating_m);
  messaging::copy_lower_triangle(a_roe_covariance_m2_, message.covariance_a_roe);
  message.bearings_used = aiding_.counters().used;
  message.bearings_refused = aiding_.counters().rejected;
  message.images_without_stars = images_without_stars_;
  message.tiles_refused = telemetry.inbox.image(camera_).counts().tiles_refused;
  telemetry.outbox.send(sighting.time, message, static_cast<std::uint8_t>(camera_));
}

void BearingSource::report_objects(const Telemetry& telemetry) const {
  const target_tracking::Sighting& sighting = tracking_.sighting();
  const auto objects = tracking_.objects();
  telemetry_objects message{};
  message.step = telemetry.step;
  message.image = sighting.image;
  constexpr std::size_t kMaxReported = sizeof message.kind / sizeof message.kind[0];
  const std::size_t count = static_cast<std::size_t>(sighting.objects) < kMaxReported
                                ? static_cast<std::size_t>(sighting.objects)
                                : kMaxReported;
  message.count = static_cast<std::int16_t>(count);
  for (std::size_t k = 0; k < count; ++k) {
    message.kind[k] = static_cast<std::int8_t>(sighting.kind[k]);
    message.star[k] = sighting.hipparcos[k];
    message.x_px[k] = static_cast<float>(objects[k].centroid_px.x());
    message.y_px[k] = static_cast<float>(objects[k].centroid_px.y());
  }
  telemetry.outbox.send(sighting.time, message, static_cast<std::uint8_t>(camera_));
}

}  // namespace vbar::fsw::measurements
