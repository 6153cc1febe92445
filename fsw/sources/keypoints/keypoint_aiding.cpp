#include "fsw/sources/keypoints/keypoint_aiding.h"

#include <array>

#include "fsw/math/cholesky.h"
#include "fsw/math/math.h"

namespace vbar::fsw::sources {
namespace {

using trunk::RelativeKnowledge;

// Half width of the penumbra, and the time before the shadow in which no attitude is initialised: one face is lit then,
// and single-image poses agree on an attitude that may be wrong by 25 deg.
constexpr double kEdge_s = 20.0;
constexpr double kBeforeShadow_s = 120.0;

// Most keypoints refused in this number of consecutive images: the attitude is initialised again if poses agree on one,
// and deactivated after the second number.
constexpr int kRefusedBeforeAttitude = 3;
constexpr int kRefusedBeforeLoss = 10;
// An attitude that keypoints have confirmed for this long, with this number of images, does not jump: the network is in
// error, for which it has this time before its poses may replace the attitude.
constexpr Duration kProven = duration_of_seconds(600);
constexpr int kProvenImages = 20;
constexpr Duration kUpset = duration_of_seconds(120);
// The pose of an image contradicts the attitude by more than this: other faces are taken for those seen.
constexpr double kOtherAttitude = 0.52;  // rad
// This number of consecutive contradicting positions inflates the covariance, the second time more than the first; the
// third time the orbit is initialised from poses.
constexpr int kFarBeforeInflation = 5;
constexpr std::array<double, 3> kInflatedVelocity = {0.1, 1.0, 1.0};  // m/s
constexpr std::array<double, 3> kInflatedDistance = {0.1, 0.3, 0.5};  // relative
// A wrong attitude has biased the position as well: keypoints of another side appear larger or smaller.
constexpr double kWrongAttitudeDistance = 0.03;  // relative
// After this number of consecutive images without the illuminated target its position is uncertain: the crop is then
// searched in the whole image.
constexpr int kMissingBeforeInflation = 12;
constexpr double kMissingVelocity = 0.005;  // m/s
constexpr double kMissingDistance = 0.1;    // relative

// Without a usable image for this long the source no longer aids.
constexpr Duration kSilence = duration_of_seconds(60);

// Errors of neighbouring images are correlated: factor on the covariance of their positions.
constexpr double kAlike = 4.0;
constexpr double kMinSigma_m = 0.01;

bool is_finite(const KeypointImage& image) {
  return image.R_camera_eci.has_value() && math::is_finite(image.R_camera_eci->sum()) &&
         math::is_finite(image.sun_eci.sum());
}

bool is_finite(const pose::PnpSolution& pnp) {
  return math::is_finite(pnp.pose.R_camera_body.sum()) && math::is_finite(pnp.pose.position_camera_m.sum()) &&
         math::is_finite(pnp.covariance.sum());
}

double range_m(const trunk::Trunk& trunk) {
  const auto target = trunk.target();
  if (!target.ok()) return 0.0;
  return math::sqrt((target.value().position_eci - trunk.servicer().position_eci).squaredNorm());
}

/// Range, 1 sigma over its value; infinite without a target.
double range_uncertainty(const trunk::Trunk& trunk) {
  constexpr double kUnknown = 1e300;
  const auto target = trunk.target();
  if (!target.ok()) return kUnknown;
  const Vector3 apart = target.value().position_eci - trunk.servicer().position_eci;
  const double square = apart.squaredNorm();
  const double variance = apart.dot(trunk.position_covariance_eci() * apart);
  return square > 0.0 && variance >= 0.0 ? math::sqrt(variance) / square : kUnknown;
}

}  // namespace

void KeypointAiding::configure(const KeypointAidingSettings& settings) {
  settings_ = settings;
  editing_.configure(settings.editing);
  seen_.configure(settings.novelty);
  start_.configure(settings.start, settings.inertia);
}

KeypointEditStatus KeypointAiding::process(const KeypointImage& image, trunk::Trunk& trunk) {
  editing_.clear_update();
  if (aid_.state() == AidState::kOff) aid_.go_to(AidState::kWaiting, image.time);
  follow_burns(trunk);
  if (trunk.has_attitude() && !(trunk::attitude_sigma(trunk.estimate()) <= settings_.widest_attitude)) {
    trunk.rest_attitude();
  }
  const KeypointEditStatus status = edit(image, trunk);
  follow_state(image.time, status);
  return status;
}

void KeypointAiding::follow_burns(const trunk::Trunk& trunk) {
  for (const trunk::Impulse& impulse : trunk.impulses()) {
    if (impulse.time >= burns_until_) start_.interrupt_orbit();
  }
  burns_until_ = trunk.epoch();
}

KeypointEditStatus KeypointAiding::edit(const KeypointImage& image, trunk::Trunk& trunk) {
  if (!trunk.own_orbit().started() || !is_finite(image)) return KeypointEditStatus::kNone;
  const CameraPose camera{*image.R_camera_eci, image.R_camera_eci->transpose() * image.camera.position_camera_m};
  light_ = light_of(image, trunk);
  has_sample_ = is_fit_for_start(image);
  if (has_sample_) {
    const navigation::PoseSample sample = sample_of(image, camera, trunk);
    q_eci_body_sample_ = sample.q_eci_body;
    start_.add(sample);
  }
  if (image.keypoints == nullptr) {
    count_missing(trunk);
    return KeypointEditStatus::kNone;
  }
  missing_in_a_row_ = 0;
  if (trunk.knowledge() != RelativeKnowledge::kEstimated) return begin_orbit(trunk);
  // Against a contradicted or uncertain orbit, keypoints would correct the attitude in place of the position.
  const bool is_orbit_certain = inflations_in_a_row_ == 0 && range_uncertainty(trunk) <= settings_.keypoint_range_share;
  if (!is_orbit_certain) return take_position(image, camera, trunk);
  if (!trunk.has_attitude() && !begin_attitude(trunk)) return take_position(image, camera, trunk);
  return take_keypoints(image, camera, trunk);
}

/// Without a target: that of the servicer, the phase unknown.
KeypointAiding::Light KeypointAiding::light_of(const KeypointImage& image, const trunk::Trunk& trunk) const {
  const auto known = trunk.target();
  const orbit::CartesianState place = known.ok() ? known.value() : trunk.servicer();
  const auto is_lit_after = [&](double dt) {
    return navigation::is_sunlit(place.position_eci + dt * place.velocity_eci, image.sun_eci);
  };
  Vector3 to_camera = Vector3::Zero();
  if (known.ok()) {
    to_camera = trunk.servicer().position_eci - place.position_eci;
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

navigation::PoseSample KeypointAiding::sample_of(const KeypointImage& image, const CameraPose& camera,
                                                 const trunk::Trunk& trunk) const {
  const pose::PnpSolution& pnp = *image.pnp;
  const Matrix3 R_eci_camera = camera.R_camera_eci.transpose();
  navigation::PoseSample sample;
  sample.time = image.time;
  sample.servicer = trunk.servicer();
  sample.relative_eci = R_eci_camera * pnp.pose.position_camera_m + camera.origin_eci;
  sample.covariance_eci = R_eci_camera * pnp.covariance.bottomRightCorner<3, 3>() * camera.R_camera_eci;
  sample.q_eci_body = Eigen::Quaterniond(Matrix3(R_eci_camera * pnp.pose.R_camera_body)).normalized();
  sample.attitude_sigma = math::sqrt(pnp.covariance.topLeftCorner<3, 3>().trace() / 3.0);
  return sample;
}

/// From the positions of the last images, if their attitudes agree.
KeypointEditStatus KeypointAiding::begin_orbit(trunk::Trunk& trunk) {
  if (!has_sample_) return KeypointEditStatus::kNone;
  const auto orbit = start_.orbit();
  if (!start_.attitude().ok() || !orbit.ok()) return KeypointEditStatus::kStart;
  if (trunk.knowledge() == RelativeKnowledge::kContradicted) ++counters_.restarts;
  trunk.begin_relative(orbit.value().roe, orbit.value().covariance, RelativeKnowledge::kEstimated);
  reset_refusals();
  inflations_in_a_row_ = 0;
  last_accepted_ = trunk.epoch();
  return KeypointEditStatus::kStart;
}

bool KeypointAiding::agrees_with_image(const navigation::AttitudeState& attitude) const {
  const Vector3 between = navigation::rotation_vector_of(attitude.q_eci_body.conjugate() * q_eci_body_sample_);
  return between.squaredNorm() <= settings_.start.agreement * settings_.start.agreement;
}

/// From the consensus of the last images, which must include the current one: after a flip most of them are older.
bool KeypointAiding::begin_attitude(trunk::Trunk& trunk) {
  if (!has_sample_ || !(range_uncertainty(trunk) <= settings_.start_range_share)) return false;
  const auto attitude = start_.attitude();
  if (!attitude.ok() || !agrees_with_image(attitude.value().attitude)) return false;
  trunk.begin_attitude(attitude.value().attitude, attitude.value().covariance);
  attitude_since_ = trunk.epoch();
  images_of_attitude_ = 0;
  if (has_begun_) {
    ++counters_.attitudes_reset;
    aid_.restarts().add(trunk.epoch());
  }
  has_begun_ = true;
  return trunk.has_attitude();
}

/// What a pose may be off by in addition to its own covariance.
Matrix3 KeypointAiding::position_covariance(const navigation::PoseSample& sample, bool is_agreed) const {
  const Vector3 range_sigma =
      (is_agreed ? settings_.agreed_range_share : settings_.pose_range_share) * sample.relative_eci;
  const double lateral_sigma = is_agreed ? kMinSigma_m : settings_.pose_lateral_sigma_m;
  return range_sigma * range_sigma.transpose() + lateral_sigma * lateral_sigma * Matrix3::Identity();
}

bool KeypointAiding::is_far(const navigation::PoseSample& sample, const trunk::Trunk& trunk) const {
  const auto target = trunk.target();
  if (!target.ok()) return true;
  const math::Cholesky<3> factor(trunk.position_covariance_eci() + sample.covariance_eci +
                                 position_covariance(sample, false));
  if (!factor.ok()) return true;
  const Vector3 miss = sample.relative_eci - (target.value().position_eci - trunk.servicer().position_eci);
  return !(factor.solve_lower(miss).squaredNorm() <= settings_.position_gate);
}

KeypointEditStatus KeypointAiding::take_position(const KeypointImage& image, const CameraPose& camera,
                                                 trunk::Trunk& trunk) {
  // In penumbra poses are wrong alike.
  if (!image.pnp || !is_finite(*image.pnp) || !light_.is_sunlit) return KeypointEditStatus::kNone;
  const navigation::PoseSample sample = sample_of(image, camera, trunk);
  if (is_far(sample, trunk)) {
    count_refusal(image.time, true, trunk);
    return KeypointEditStatus::kRefused;
  }
  reset_refusals();
  inflations_in_a_row_ = 0;
  const auto agreed = start_.attitude();
  const bool is_agreed = has_sample_ && agreed.ok() && agrees_with_image(agreed.value().attitude);
  const Matrix3 covariance = kAlike * sample.covariance_eci + position_covariance(sample, is_agreed);
  trunk::MeasurementBatch& batch = trunk.workspace();
  if (position_rows(trunk, sample.relative_eci, covariance, batch) != Status::kOk ||
      !trunk.update(KeypointEditing::kSource, batch)) {
    return KeypointEditStatus::kRefused;
  }
  ++counters_.positions_used;
  last_accepted_ = image.time;
  return KeypointEditStatus::kPosition;
}

void KeypointAiding::activate_blocks(std::size_t camera, trunk::Trunk& trunk) const {
  trunk::Estimate& estimate = trunk.estimate();
  const auto& processes = trunk.settings().processes;
  const int mount = mount_at(camera);
  if (trunk::is_active<KeypointOrigin>(estimate) && !estimate.is_idle(mount)) return;
  if (!trunk::is_active<KeypointOrigin>(estimate)) {
    trunk::begin_block<KeypointOrigin>(estimate, processes.of<KeypointOrigin>());
  }
  for (int axis = 0; axis < kMountAxes && estimate.is_idle(mount + 1); ++axis) {
    estimation::begin_process(estimate, mount + axis, processes.of<CameraMounts>());
  }
  trunk.finish_update();
}

KeypointEditStatus KeypointAiding::take_keypoints(const KeypointImage& image, const CameraPose& camera,
                                                  trunk::Trunk& trunk) {
  activate_blocks(image.camera.model.camera, trunk);
  const Matrix3 R_camera_body = camera.R_camera_eci * trunk.attitude().state().q_eci_body.toRotationMatrix();
  const double range = range_m(trunk);
  const View view{Eigen::Quaterniond(R_camera_body).normalized(), range > 0.0 ? math::log(range) : 0.0};
  const KeypointsUpdate& update =
      editing_.take(trunk, image.time, *image.keypoints, camera, image.camera.model, seen_.scale(view, image.time));
  bool is_any_usable = false;
  for (const pose::Keypoint& keypoint : *image.keypoints) is_any_usable = is_any_usable || is_usable(keypoint);
  if (!is_any_usable) return KeypointEditStatus::kNone;
  const int used = update.accepted ? update.used : 0;
  if (update.accepted) aid_.consistency().add(update.nis, 2 * update.used);
  counters_.keypoints_used += used;
  counters_.keypoints_refused += update.usable - used;
  judge_network(image, camera, update.is_mostly_rejected(settings_.editing.max_refused_share), trunk);
  if (update.accepted) {
    ++images_of_attitude_;
    seen_.add(view, image.time);
    ++counters_.images_used;
    reset_refusals();
    inflations_in_a_row_ = 0;
    last_accepted_ = image.time;
    return KeypointEditStatus::kFilter;
  }
  // None at all: the estimate expects the target behind the camera.
  if (update.usable == 0 || update.is_mostly_rejected(settings_.editing.max_refused_share)) {
    const bool has_pose = image.pnp && is_finite(*image.pnp);
    count_refusal(image.time, has_pose && is_far(sample_of(image, camera, trunk), trunk), trunk);
  }
  return KeypointEditStatus::kRefused;
}

void KeypointAiding::judge_network(const KeypointImage& image, const CameraPose& camera, bool is_refused,
                                   const trunk::Trunk& trunk) {
  if (!light_.is_lit || !trunk.has_attitude() || !image.pnp || !is_finite(*image.pnp)) return;
  if (verdict_ && verdict_->contradicts) return;  // of another camera in the same step
  const Eigen::Quaterniond q_eci_body = sample_of(image, camera, trunk).q_eci_body;
  const Vector3 between = navigation::rotation_vector_of(trunk.attitude().state().q_eci_body.conjugate() * q_eci_body);
  const double angle = math::sqrt(between.squaredNorm());
  verdict_ = NetworkVerdict{.contradicts = is_refused && angle > kOtherAttitude, .angle = angle};
}

/// Whether the network may be in error in place of the attitude.
bool KeypointAiding::is_upset(GpsTime time) const {
  const bool is_proven = images_of_attitude_ >= kProvenImages && last_accepted_ - attitude_since_ >= kProven;
  return is_proven && time - last_accepted_ < kUpset;
}

/// Refusals of an ill-lit target count toward no persistence.
void KeypointAiding::count_refusal(GpsTime time, bool is_position_far, trunk::Trunk& trunk) {
  ++counters_.images_refused;
  if (!light_.is_lit) return;
  ++refused_in_a_row_;
  far_in_a_row_ = is_position_far ? far_in_a_row_ + 1 : 0;
  if (far_in_a_row_ >= kFarBeforeInflation) return contradict_orbit(time, trunk);
  if (is_position_far || !trunk.has_attitude() || refused_in_a_row_ < kRefusedBeforeAttitude) return;
  if (is_upset(time)) return aid_.go_to(AidState::kSuspended, time);
  // The range was known before the contradiction, so that the consensus is judged before the inflation.
  const bool has_renewed = begin_attitude(trunk);
  if (!has_renewed && refused_in_a_row_ < kRefusedBeforeLoss) return;
  if (!has_renewed) {
    trunk.rest_attitude();
    aid_.go_to(AidState::kFailed, time);
  }
  reset_refusals();
  inflate(0.0, kWrongAttitudeDistance, trunk);
}

/// `distance`: relative. An orbit that receivers determine is not changed because images contradict it.
void KeypointAiding::inflate(double velocity_sigma, double distance, trunk::Trunk& trunk) {
  if (trunk.is_precisely_determined()) return;
  trunk.inflate_relative(velocity_sigma, distance * range_m(trunk));
  ++counters_.inflations;
}

/// An illuminated target at its estimated position is detected.
void KeypointAiding::count_missing(trunk::Trunk& trunk) {
  if (!light_.is_lit || !trunk.has_relative() || range_uncertainty(trunk) > kMissingDistance) return;
  if (++missing_in_a_row_ < kMissingBeforeInflation) return;
  missing_in_a_row_ = 0;
  inflate(kMissingVelocity, kMissingDistance, trunk);
}

void KeypointAiding::contradict_orbit(GpsTime time, trunk::Trunk& trunk) {
  reset_refusals();
  aid_.go_to(AidState::kSuspended, time);
  if (trunk.is_precisely_determined()) {
    trunk.rest_attitude();  // with which the poses were wrong
    return;
  }
  inflate(kInflatedVelocity[inflations_in_a_row_], kInflatedDistance[inflations_in_a_row_], trunk);
  if (++inflations_in_a_row_ < kInflatedVelocity.size()) return;
  inflations_in_a_row_ = 0;
  trunk.rest_attitude();
  trunk.distrust_relative();
  aid_.go_to(AidState::kFailed, time);
}

void KeypointAiding::reset_refusals() {
  refused_in_a_row_ = 0;
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
    case KeypointEditStatus::kRefused:
      return check_age(time);
  }
}

void KeypointAiding::check_age(GpsTime now) {
  const bool is_active = aid_.state() == AidState::kAiding || aid_.state() == AidState::kStarting;
  if (is_active && now - last_accepted_ > kSilence && now - aid_.since() > kSilence) {
    aid_.go_to(AidState::kSuspended, now);
  }
}

}  // namespace vbar::fsw::sources
