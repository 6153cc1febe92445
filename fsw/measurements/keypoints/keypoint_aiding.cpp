#include "fsw/measurements/keypoints/keypoint_aiding.h"

#include <algorithm>

#include "fsw/math/cholesky.h"
#include "fsw/math/math.h"

namespace vbar::fsw::measurements {
namespace {

using filter::SolutionStatus;

// Half width of the penumbra, and the time before the shadow in which no attitude is initialised: one face is lit then,
// and single-image poses agree on an attitude that may be wrong by 25 deg.
constexpr double kEdge_s = 20.0;
constexpr double kBeforeShadow_s = 120.0;

// Most keypoints rejected in this number of consecutive images: the attitude is initialised again if poses agree on
// one, and deactivated after the second number.
constexpr int kRejectedBeforeAttitude = 3;
constexpr int kRejectedBeforeLoss = 10;
// An attitude that keypoints have confirmed for this long, with this number of images, does not jump: the network is in
// error, for which it has this time before its poses may replace the attitude.
constexpr Duration kProven = duration_of_seconds(600);
constexpr int kProvenImages = 20;
constexpr Duration kUpset = duration_of_seconds(120);
// The pose of an image contradicts the attitude by more than this: other faces are taken for those seen.
constexpr double kOtherAttitude = 0.52;  // rad
// This number of consecutive contradicting positions decides whether the orbit is opened; the third time in a row it is
// initialised from poses.
constexpr int kFarBeforeDecision = 5;
constexpr int kMaxOpenings = 3;
// Poses contradict each other because the crop is in the wrong place, if at all for this long: the errors of the
// network change with the tumble of the target.
constexpr Duration kUndecided = duration_of_seconds(1800);
// The burn that would have caused the miss in the time since the last image that agreed, times this: it may have been
// flown late.
constexpr double kBurnMargin = 2.0;
constexpr double kShortestSince_s = 10.0;
constexpr double kLongestSince_s = 6000.0;
// A wrong attitude has biased the position as well: keypoints of another side appear larger or smaller.
constexpr double kWrongAttitudeDistance = 0.03;  // relative
// After this number of consecutive images without the illuminated target it is searched in the whole image.
constexpr int kMissingBeforeSearch = 12;
constexpr double kMissingDistance = 0.1;  // relative: a range less certain than this is searched anyway

// Without a usable image for this long the source no longer aids.
constexpr Duration kSilence = duration_of_seconds(60);

// Errors of neighbouring images are correlated: factor on the covariance of their positions.
constexpr double kAlike = 4.0;
constexpr double kMinSigma_m = 0.01;
// Largest correlation of the errors of neighbouring positions.
constexpr double kMaxLikeness = 0.95;

bool is_finite(const KeypointImage& image) {
  return image.R_camera_eci.has_value() && math::is_finite(image.R_camera_eci->sum()) &&
         math::is_finite(image.sun_eci.sum());
}

bool is_finite(const pose::PnpSolution& pnp) {
  return math::is_finite(pnp.pose.R_camera_body.sum()) && math::is_finite(pnp.pose.position_camera_m.sum()) &&
         math::is_finite(pnp.covariance.sum());
}

double range_m(const filter::RelativeNavigationFilter& filter) {
  const auto target = filter.target();
  if (!target.ok()) return 0.0;
  return math::sqrt((target.value().position_eci - filter.servicer().position_eci).squaredNorm());
}

/// Range, 1 sigma over its value; infinite without a target.
double range_uncertainty(const filter::RelativeNavigationFilter& filter) {
  constexpr double kUnknown = 1e300;
  const auto target = filter.target();
  if (!target.ok()) return kUnknown;
  const Vector3 apart = target.value().position_eci - filter.servicer().position_eci;
  const double square = apart.squaredNorm();
  const double variance = apart.dot(filter.position_covariance_eci() * apart);
  return square > 0.0 && variance >= 0.0 ? math::sqrt(variance) / square : kUnknown;
}

}  // namespace

void KeypointAiding::configure(const KeypointAidingSettings& settings) {
  settings_ = settings;
  editing_.configure(settings.editing);
  seen_.configure(settings.novelty);
  start_.configure(settings.start, settings.inertia);
}

KeypointEditStatus KeypointAiding::process(const KeypointImage& image, filter::RelativeNavigationFilter& filter) {
  editing_.clear_update();
  if (aid_.state() == AidState::kOff) aid_.go_to(AidState::kWaiting, image.time);
  follow_burns(filter);
  if (filter.has_attitude() && !(filter::attitude_sigma(filter.estimate()) <= settings_.widest_attitude)) {
    filter.deactivate_attitude();
  }
  const KeypointEditStatus status = edit(image, filter);
  follow_state(image.time, status);
  return status;
}

void KeypointAiding::follow_burns(const filter::RelativeNavigationFilter& filter) {
  for (const filter::Impulse& impulse : filter.impulses()) {
    if (impulse.time >= burns_until_) start_.interrupt_orbit();
  }
  burns_until_ = filter.epoch();
}

KeypointEditStatus KeypointAiding::edit(const KeypointImage& image, filter::RelativeNavigationFilter& filter) {
  if (!filter.absolute_orbit().started() || !is_finite(image)) return KeypointEditStatus::kNone;
  const CameraPose camera{*image.R_camera_eci, image.R_camera_eci->transpose() * image.camera.position_camera_m};
  light_ = light_of(image, filter);
  has_sample_ = is_fit_for_start(image);
  if (has_sample_) {
    const measurements::PoseSample sample = sample_of(image, camera, filter);
    q_eci_body_sample_ = sample.q_eci_body;
    start_.add(sample);
  }
  if (image.keypoints == nullptr) {
    count_missing(filter);
    return KeypointEditStatus::kNone;
  }
  missing_in_a_row_ = 0;
  if (filter.solution_status() != SolutionStatus::kEstimated) return begin_orbit(filter);
  // Against a contradicted or uncertain orbit, keypoints would correct the attitude in place of the position.
  const bool is_orbit_certain = openings_in_a_row_ == 0 && range_uncertainty(filter) <= settings_.keypoint_range_share;
  if (!is_orbit_certain) return take_position(image, camera, filter);
  if (!filter.has_attitude() && !initialize_attitude(filter)) return take_position(image, camera, filter);
  return take_keypoints(image, camera, filter);
}

/// Without a target: that of the servicer, the phase unknown.
KeypointAiding::Light KeypointAiding::light_of(const KeypointImage& image,
                                               const filter::RelativeNavigationFilter& filter) const {
  const auto known = filter.target();
  const orbit::CartesianState place = known.ok() ? known.value() : filter.servicer();
  const auto is_lit_after = [&](double dt) {
    return filter::is_sunlit(place.position_eci + dt * place.velocity_eci, image.sun_eci);
  };
  Vector3 to_camera = Vector3::Zero();
  if (known.ok()) {
    to_camera = filter.servicer().position_eci - place.position_eci;
  } else if (image.pnp) {
    to_camera = -(image.R_camera_eci->transpose() * image.pnp->pose.position_camera_m);
  }
  const double range = math::sqrt(to_camera.squaredNorm());
  const bool is_from_front = to_camera.dot(image.sun_eci) >= math::cos(settings_.max_phase) * range;
  Light light;
  light.is_sunlit = is_lit_after(-kEdge_s) && is_lit_after(kEdge_s);
  light.is_lit = light.is_sunlit && is_from_front;
  light.may_start = light.is_lit && is_lit_after(kBeforeShadow_s);
  return light;
}

/// A pose with enough keypoints, or with a certain attitude, of an illuminated target.
bool KeypointAiding::is_fit_for_start(const KeypointImage& image) const {
  if (!image.pnp || !is_finite(*image.pnp) || !light_.may_start) return false;
  const double variance = image.pnp->covariance.topLeftCorner<3, 3>().trace() / 3.0;
  return image.pnp->inliers >= settings_.start_inliers ||
         variance <= settings_.start_attitude_sigma * settings_.start_attitude_sigma;
}

measurements::PoseSample KeypointAiding::sample_of(const KeypointImage& image, const CameraPose& camera,
                                                   const filter::RelativeNavigationFilter& filter) const {
  const pose::PnpSolution& pnp = *image.pnp;
  const Matrix3 R_eci_camera = camera.R_camera_eci.transpose();
  measurements::PoseSample sample;
  sample.time = image.time;
  sample.servicer = filter.servicer();
  sample.relative_eci = R_eci_camera * pnp.pose.position_camera_m + camera.origin_eci;
  sample.covariance_eci = R_eci_camera * pnp.covariance.bottomRightCorner<3, 3>() * camera.R_camera_eci;
  sample.q_eci_body = Eigen::Quaterniond(Matrix3(R_eci_camera * pnp.pose.R_camera_body)).normalized();
  sample.attitude_sigma = math::sqrt(pnp.covariance.topLeftCorner<3, 3>().trace() / 3.0);
  return sample;
}

/// From the positions of the last images, if their attitudes agree.
KeypointEditStatus KeypointAiding::begin_orbit(filter::RelativeNavigationFilter& filter) {
  if (!has_sample_) return KeypointEditStatus::kNone;
  const auto orbit = start_.orbit();
  if (!start_.attitude().ok() || !orbit.ok()) return KeypointEditStatus::kStart;
  if (filter.solution_status() == SolutionStatus::kInconsistent) ++counters_.restarts;
  filter.initialize_relative(orbit.value().roe, orbit.value().covariance, SolutionStatus::kEstimated);
  accept(filter.epoch());
  return KeypointEditStatus::kStart;
}

bool KeypointAiding::agrees_with_image(const filter::AttitudeState& attitude) const {
  const Vector3 between = filter::rotation_vector_of(attitude.q_eci_body.conjugate() * q_eci_body_sample_);
  return between.squaredNorm() <= settings_.start.agreement * settings_.start.agreement;
}

/// From the consensus of the last images, which must include the current one: after a flip most of them are older.
bool KeypointAiding::initialize_attitude(filter::RelativeNavigationFilter& filter) {
  if (!has_sample_) return false;
  const auto attitude = start_.attitude();
  if (!attitude.ok() || !agrees_with_image(attitude.value().attitude)) return false;
  const bool is_range_known = range_uncertainty(filter) <= settings_.start_range_share;
  if (!is_range_known && attitude.value().agreeing < settings_.start_images) return false;
  filter.initialize_attitude(attitude.value().attitude, attitude.value().covariance);
  attitude_since_ = filter.epoch();
  images_of_attitude_ = 0;
  if (has_begun_) {
    ++counters_.attitudes_reset;
    aid_.restarts().add(filter.epoch());
  }
  has_begun_ = true;
  return filter.has_attitude();
}

/// What a pose may be off by in addition to its own covariance.
Matrix3 KeypointAiding::position_covariance(const measurements::PoseSample& sample, bool is_agreed) const {
  const Vector3 range_sigma =
      (is_agreed ? settings_.agreed_range_share : settings_.pose_range_share) * sample.relative_eci;
  const double lateral_sigma = is_agreed ? kMinSigma_m : settings_.pose_lateral_sigma_m;
  return range_sigma * range_sigma.transpose() + lateral_sigma * lateral_sigma * Matrix3::Identity();
}

/// Factor on the covariance of a position whose error is correlated with that of the last one, so that a number of
/// such positions contributes as much as their mean under the first-order correlation r is worth: the weight of the
/// first one, and (1 - r) / (1 + r) of it from each further one.
double KeypointAiding::likeness_factor(const View& view) const {
  if (!view_of_position_) return 1.0;
  const double r = math::exp(-distance(*view_of_position_, view) / settings_.novelty.angle);
  return (1.0 + r) / (1.0 - std::min(r, kMaxLikeness));
}

/// Distance of a pose from the estimate, m; empty within the gate.
std::optional<double> KeypointAiding::distance_if_far(const measurements::PoseSample& sample,
                                                      const filter::RelativeNavigationFilter& filter) const {
  const auto target = filter.target();
  if (!target.ok()) return 0.0;
  const math::Cholesky<3> factor(filter.position_covariance_eci() + sample.covariance_eci +
                                 position_covariance(sample, false));
  const Vector3 miss = sample.relative_eci - (target.value().position_eci - filter.servicer().position_eci);
  if (factor.ok() && factor.solve_lower(miss).squaredNorm() <= settings_.position_gate) return std::nullopt;
  return math::sqrt(miss.squaredNorm());
}

KeypointEditStatus KeypointAiding::take_position(const KeypointImage& image, const CameraPose& camera,
                                                 filter::RelativeNavigationFilter& filter) {
  // In penumbra all poses have the same error.
  if (!image.pnp || !is_finite(*image.pnp) || !light_.is_sunlit) return KeypointEditStatus::kNone;
  const measurements::PoseSample sample = sample_of(image, camera, filter);
  if (const std::optional<double> miss_m = distance_if_far(sample, filter)) {
    count_rejection(image.time, miss_m, filter);
    return KeypointEditStatus::kRejected;
  }
  const GpsTime before = last_accepted_;
  accept(image.time);
  const auto agreed = start_.attitude();
  const bool is_agreed = has_sample_ && agreed.ok() && agrees_with_image(agreed.value().attitude);
  const View view{Eigen::Quaterniond(image.pnp->pose.R_camera_body).normalized(),
                  0.5 * math::log(sample.relative_eci.squaredNorm())};
  const Matrix3 covariance =
      kAlike * sample.covariance_eci + likeness_factor(view) * position_covariance(sample, is_agreed);
  filter::MeasurementBatch& batch = filter.workspace();
  if (position_rows(filter, sample.relative_eci, covariance, batch) != Status::kOk ||
      !filter.update(KeypointEditing::kSource, batch)) {
    last_accepted_ = before;
    return KeypointEditStatus::kRejected;
  }
  view_of_position_ = view;
  ++counters_.positions_used;
  return KeypointEditStatus::kPosition;
}

void KeypointAiding::activate_blocks(std::size_t camera, filter::RelativeNavigationFilter& filter) const {
  filter::Estimate& estimate = filter.estimate();
  const auto& processes = filter.settings().processes;
  const int mount = mount_at(camera);
  if (filter::is_active<KeypointOrigin>(estimate) && !estimate.is_inactive(mount)) return;
  if (!filter::is_active<KeypointOrigin>(estimate)) {
    filter::initialize_block<KeypointOrigin>(estimate, processes.of<KeypointOrigin>());
  }
  for (int axis = 0; axis < kMountAxes && estimate.is_inactive(mount + 1); ++axis) {
    estimation::initialize_process(estimate, mount + axis, processes.of<CameraMounts>());
  }
  filter.finish_update();
}

KeypointEditStatus KeypointAiding::take_keypoints(const KeypointImage& image, const CameraPose& camera,
                                                  filter::RelativeNavigationFilter& filter) {
  activate_blocks(image.camera.model.camera, filter);
  const Matrix3 R_camera_body = camera.R_camera_eci * filter.attitude().state().q_eci_body.toRotationMatrix();
  const double range = range_m(filter);
  const View view{Eigen::Quaterniond(R_camera_body).normalized(), range > 0.0 ? math::log(range) : 0.0};
  const KeypointsUpdate& update = editing_.process_measurement(filter, image.time, *image.keypoints, camera,
                                                               image.camera.model, seen_.scale(view, image.time));
  bool is_any_usable = false;
  for (const pose::Keypoint& keypoint : *image.keypoints) is_any_usable = is_any_usable || is_usable(keypoint);
  if (!is_any_usable) return KeypointEditStatus::kNone;
  const int used = update.accepted ? update.used : 0;
  if (update.accepted) aid_.consistency().add(update.nis, 2 * update.used);
  counters_.keypoints_used += used;
  counters_.keypoints_rejected += update.usable - used;
  judge_network(image, camera, update.is_mostly_rejected(settings_.editing.max_rejected_share), filter);
  if (update.accepted) {
    ++images_of_attitude_;
    seen_.add(view, image.time);
    ++counters_.images_used;
    accept(image.time);
    return KeypointEditStatus::kFilter;
  }
  // None at all: the estimate expects the target behind the camera.
  if (update.usable == 0 || update.is_mostly_rejected(settings_.editing.max_rejected_share)) {
    const bool has_pose = image.pnp && is_finite(*image.pnp);
    count_rejection(image.time, has_pose ? distance_if_far(sample_of(image, camera, filter), filter) : std::nullopt,
                    filter);
  }
  return KeypointEditStatus::kRejected;
}

void KeypointAiding::judge_network(const KeypointImage& image, const CameraPose& camera, bool is_rejected,
                                   const filter::RelativeNavigationFilter& filter) {
  if (!light_.is_lit || !filter.has_attitude() || !image.pnp || !is_finite(*image.pnp)) return;
  if (verdict_ && verdict_->contradicts) return;  // of another camera in the same step
  const Eigen::Quaterniond q_eci_body = sample_of(image, camera, filter).q_eci_body;
  const Vector3 between = filter::rotation_vector_of(filter.attitude().state().q_eci_body.conjugate() * q_eci_body);
  const double angle = math::sqrt(between.squaredNorm());
  verdict_ = NetworkVerdict{.contradicts = is_rejected && angle > kOtherAttitude, .angle = angle};
}

/// Whether keypoints have confirmed the attitude, and with it the position, for long.
bool KeypointAiding::is_proven() const {
  return images_of_attitude_ >= kProvenImages && last_accepted_ - attitude_since_ >= kProven;
}

/// Whether the network may be in error in place of the attitude.
bool KeypointAiding::is_upset(GpsTime time) const {
  return is_proven() && time - last_accepted_ < kUpset;
}

/// Whether the poses of the last images, the present one among them, are those of one motion.
bool KeypointAiding::poses_agree() const {
  const auto attitude = start_.attitude();
  return has_sample_ && attitude.ok() && agrees_with_image(attitude.value().attitude) && start_.orbit().ok();
}

void KeypointAiding::accept(GpsTime time) {
  reset_rejections();
  openings_in_a_row_ = 0;
  searches_ = false;
  last_accepted_ = time;
}

/// Refusals of an ill-lit target count toward no persistence.
void KeypointAiding::count_rejection(GpsTime time, const std::optional<double>& miss_m,
                                     filter::RelativeNavigationFilter& filter) {
  ++counters_.images_rejected;
  if (!light_.is_lit) return;
  ++rejected_in_a_row_;
  far_in_a_row_ = miss_m ? far_in_a_row_ + 1 : 0;
  if (far_in_a_row_ >= kFarBeforeDecision) return contradict_orbit(time, *miss_m, filter);
  if (miss_m || !filter.has_attitude() || rejected_in_a_row_ < kRejectedBeforeAttitude) return;
  if (is_upset(time)) return aid_.go_to(AidState::kSuspended, time);
  // An attitude that was wrong from its start has biased the position. The range was known before the contradiction, so
  // that the consensus is judged before the inflation.
  const bool has_biased = !is_proven();
  const bool has_renewed = initialize_attitude(filter);
  if (!has_renewed && rejected_in_a_row_ < kRejectedBeforeLoss) return;
  if (!has_renewed) {
    filter.deactivate_attitude();
    aid_.go_to(AidState::kFailed, time);
  }
  reset_rejections();
  if (!has_biased || filter.is_precisely_determined()) return;
  filter.inflate_relative(0.0, kWrongAttitudeDistance * range_m(filter));
  ++counters_.inflations;
}

/// An illuminated target at its estimated position is detected. That it is not shows nothing of where it is.
void KeypointAiding::count_missing(const filter::RelativeNavigationFilter& filter) {
  if (!light_.is_lit || !filter.has_relative() || range_uncertainty(filter) > kMissingDistance) return;
  if (++missing_in_a_row_ >= kMissingBeforeSearch) searches_ = true;
}

/// The estimate was right when an image agreed last: a burn since then explains the miss.
void KeypointAiding::open_orbit(GpsTime time, double miss_m, filter::RelativeNavigationFilter& filter) {
  const double since_s = std::clamp(seconds(time - last_accepted_), kShortestSince_s, kLongestSince_s);
  filter.inflate_by_burn(last_accepted_, kBurnMargin * miss_m / since_s);
  ++counters_.inflations;
}

void KeypointAiding::contradict_orbit(GpsTime time, double miss_m, filter::RelativeNavigationFilter& filter) {
  reset_rejections();
  aid_.go_to(AidState::kSuspended, time);
  searches_ = true;
  if (filter.is_precisely_determined()) {
    filter.deactivate_attitude();  // with which the poses were wrong
    return;
  }
  if (!poses_agree() && time - last_accepted_ < kUndecided) {
    ++counters_.undecided;
    return;
  }
  open_orbit(time, miss_m, filter);
  if (++openings_in_a_row_ < kMaxOpenings) return;
  openings_in_a_row_ = 0;
  filter.deactivate_attitude();
  filter.mark_inconsistent();
  aid_.go_to(AidState::kFailed, time);
}

void KeypointAiding::reset_rejections() {
  rejected_in_a_row_ = 0;
  far_in_a_row_ = 0;
}

void KeypointAiding::follow_state(GpsTime time, KeypointEditStatus status) {
  switch (status) {
    case KeypointEditStatus::kFilter:
      return aid_.go_to(AidState::kAiding, time);
    case KeypointEditStatus::kPosition:
    case KeypointEditStatus::kStart:
      return aid_.go_to(AidState::kStarting, time);
    case KeypointEditStatus::kNone:
    case KeypointEditStatus::kRejected:
      return check_age(time);
  }
}

void KeypointAiding::check_age(GpsTime now) {
  const bool is_active = aid_.state() == AidState::kAiding || aid_.state() == AidState::kStarting;
  if (is_active && now - last_accepted_ > kSilence && now - aid_.since() > kSilence) {
    aid_.go_to(AidState::kSuspended, now);
  }
}

}  // namespace vbar::fsw::measurements
