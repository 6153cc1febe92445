#include "fsw/navigation/pose_navigation.h"

#include "fsw/math/cholesky.h"
#include "fsw/math/math.h"
#include "fsw/orbit/mean_osculating.h"
#include "fsw/orbit/roe.h"
#include "fsw/orbit/rtn.h"

namespace vbar::fsw::navigation {
namespace {

constexpr Duration kSegment = duration_of_seconds(20);
constexpr int kMaxSegments = 4000;

// Most keypoints refused in this number of consecutive images: the attitude is considered wrong.
constexpr int kRefusedBeforeAttitude = 3;
// After this number without a consensus attitude, or with contradicting positions, the whole filter is reset.
constexpr int kRefusedBeforeRestart = 20;
constexpr int kFarBeforeRestart = 5;

constexpr double kHalfLight_s = 15.0;  // half width of the penumbra

constexpr Duration kOldestApriori = duration_of_seconds(600);

// 1 sigma of an unknown attitude and rate: large enough for has_attitude() to be false, and within the range of
// the filter's sigma points.
constexpr double kUnknownTurn = 0.8;
constexpr double kUnknownRate = 0.02;

Matrix6 unknown_attitude() {
  Vector6 variance;
  variance.head<3>().setConstant(kUnknownTurn * kUnknownTurn);
  variance.tail<3>().setConstant(kUnknownRate * kUnknownRate);
  return variance.asDiagonal();
}

}  // namespace

Status PoseNavigation::configure(const PoseSettings& settings) {
  settings_ = settings;
  own_orbit_ = OwnOrbit(settings.own_orbit);
  refused_in_a_row_ = 0;
  far_in_a_row_ = 0;
  last_update_ = {};
  const Status status = filter_.configure(settings.filter);
  start_.configure(settings.start, filter_.inertia());
  return status;
}

PoseEditStatus PoseNavigation::update(const PoseEpoch& epoch, std::span<const Burn> burns) {
  last_update_ = {};
  if (own_orbit_.started()) {
    if (epoch.time < epoch_) return PoseEditStatus::kNone;
    advance(epoch.time, epoch.sun_eci, burns);
    if (epoch.servicer_gnss.has_value()) own_orbit_.take(*epoch.servicer_gnss);
  } else if (epoch.servicer_gnss.has_value()) {
    own_orbit_.begin(*epoch.servicer_gnss);
    epoch_ = epoch.time;
    begin_apriori();
  }
  if (filter_.started() && !has_attitude()) filter_.set_attitude(filter_.attitude(), unknown_attitude());
  if (!own_orbit_.started() || !epoch.R_camera_eci.has_value()) return PoseEditStatus::kNone;
  CameraPose camera;
  camera.R_camera_eci = *epoch.R_camera_eci;
  camera.origin_eci = camera.R_camera_eci.transpose() * settings_.camera_position_camera_m;
  has_sample_ = is_fit_for_start(epoch);
  if (has_sample_) start_.add(sample_of(epoch, camera));
  if (!filter_.started()) return has_sample_ ? begin() : PoseEditStatus::kNone;
  if (!has_attitude() && !renew_attitude()) return take_position_only(epoch, camera);
  if (epoch.keypoints == nullptr) return PoseEditStatus::kNone;
  return take_keypoints(epoch, camera);
}

void PoseNavigation::advance(GpsTime time, const Vector3& sun_eci, std::span<const Burn> burns) {
  const auto coast_to = [&](GpsTime goal) {
    for (int segment = 0; segment < kMaxSegments && epoch_ < goal; ++segment) {
      const GpsTime next = goal - epoch_ > kSegment ? epoch_ + kSegment : goal;
      const Propagation propagation(epoch_, settings_.earth, sun_eci);
      const double dt = seconds(next - epoch_);
      filter_.advance(own_orbit_.state(), sun_eci, dt);
      own_orbit_.advance(propagation, dt);
      epoch_ = next;
    }
  };
  for (const Burn& burn : burns) {
    if (burn.time < epoch_) continue;
    if (burn.time >= time) break;
    coast_to(burn.time);
    const orbit::CartesianState servicer = own_orbit_.state();
    const Vector3 dv_eci = orbit::R_rtn_eci(servicer).transpose() * burn.dv_rtn;
    const double sigma =
        settings_.filter.maneuver_sigma + settings_.filter.maneuver_sigma_relative * math::sqrt(dv_eci.squaredNorm());
    filter_.add_servicer_impulse(servicer, dv_eci);
    own_orbit_.add_impulse(dv_eci, sigma);
    start_.interrupt_orbit();
  }
  coast_to(time);
}

/// A pose with enough keypoints, or with a certain attitude; not in the penumbra at the edge of the Earth's shadow.
bool PoseNavigation::is_fit_for_start(const PoseEpoch& epoch) const {
  if (!epoch.pnp.has_value()) return false;
  const orbit::CartesianState& servicer = own_orbit_.state();
  const Vector3 on_the_way = kHalfLight_s * servicer.velocity_eci;
  const bool is_at_edge = is_sunlit(servicer.position_eci - on_the_way, epoch.sun_eci) !=
                          is_sunlit(servicer.position_eci + on_the_way, epoch.sun_eci);
  if (is_at_edge) return false;
  const double variance = epoch.pnp->covariance.topLeftCorner<3, 3>().trace() / 3.0;
  return epoch.pnp->inliers >= settings_.start_inliers ||
         variance <= settings_.start_attitude_sigma * settings_.start_attitude_sigma;
}

PoseSample PoseNavigation::sample_of(const PoseEpoch& epoch, const CameraPose& camera) const {
  const pose::PnpSolution& pnp = *epoch.pnp;
  const Matrix3 R_eci_camera = camera.R_camera_eci.transpose();
  PoseSample sample;
  sample.time = epoch.time;
  sample.servicer = own_orbit_.state();
  sample.relative_eci = R_eci_camera * pnp.pose.position_camera_m + camera.origin_eci;
  sample.covariance_eci = R_eci_camera * pnp.covariance.bottomRightCorner<3, 3>() * camera.R_camera_eci;
  sample.q_eci_body = Eigen::Quaterniond(Matrix3(R_eci_camera * pnp.pose.R_camera_body)).normalized();
  sample.attitude_sigma = math::sqrt(pnp.covariance.topLeftCorner<3, 3>().trace() / 3.0);
  return sample;
}

/// The a-priori orbit; the attitude is not yet known.
void PoseNavigation::begin_apriori() {
  if (!settings_.apriori.has_value()) return;
  const PoseApriori& known = *settings_.apriori;
  const auto chief = orbit::qns_from_cartesian(own_orbit_.state());
  if (!chief.ok() || known.time > epoch_ || epoch_ - known.time > kOldestApriori) return;
  const auto chief_mean = orbit::mean_from_osculating(chief.value());
  if (!chief_mean.ok()) return;
  const double a = chief_mean.value().a;
  Matrix6 drift = Matrix6::Identity();
  drift(1, 0) = -1.5 * orbit::mean_motion(a) * seconds(epoch_ - known.time);
  const Vector6 roe = drift * known.a_roe_m / a;
  const auto target = orbit::osculating_from_mean(orbit::qns_from_roe(chief_mean.value(), roe));
  if (!target.ok()) return;
  const Vector6 variance = (known.sigma_a_roe_m / a).cwiseAbs2();
  const Matrix6 covariance = drift.lazyProduct(variance.asDiagonal().toDenseMatrix()).lazyProduct(drift.transpose());
  filter_.begin(orbit::roe_from_qns(chief.value(), target.value()), covariance, AttitudeState{}, unknown_attitude());
  if (filter_.started()) last_measurement_ = known.time;
}

PoseEditStatus PoseNavigation::begin() {
  const auto attitude = start_.attitude();
  const auto orbit = start_.orbit();
  if (!attitude.ok() || !orbit.ok()) return PoseEditStatus::kStart;
  filter_.begin(orbit.value().roe, orbit.value().covariance, attitude.value().attitude, attitude.value().covariance);
  refused_in_a_row_ = 0;
  far_in_a_row_ = 0;
  if (filter_.started()) last_measurement_ = epoch_;
  return PoseEditStatus::kStart;
}

/// From the consensus of the last images, including the current one.
bool PoseNavigation::renew_attitude() {
  if (!has_sample_) return false;
  const auto attitude = start_.attitude();
  if (!attitude.ok()) return false;
  filter_.set_attitude(attitude.value().attitude, attitude.value().covariance);
  ++counters_.attitudes_reset;
  return true;
}

bool PoseNavigation::is_far_from_filter(const PoseSample& sample) const {
  const auto seen = filter_.target(own_orbit_.state());
  if (!seen.ok()) return true;
  const Vector3 range_sigma = settings_.pose_range_share * sample.relative_eci;
  const Matrix3 covariance = filter_.position_covariance(own_orbit_.state()) + sample.covariance_eci +
                             range_sigma * range_sigma.transpose() + 1e-4 * Matrix3::Identity();
  const math::Cholesky<3> factor(covariance);
  if (!factor.ok()) return true;
  const Vector3 miss = sample.relative_eci - (seen.value().position_eci - own_orbit_.state().position_eci);
  return !(factor.solve_lower(miss).squaredNorm() <= settings_.position_gate);
}

PoseEditStatus PoseNavigation::take_position_only(const PoseEpoch& epoch, const CameraPose& camera) {
  if (!epoch.pnp.has_value()) return PoseEditStatus::kNone;
  const PoseSample sample = sample_of(epoch, camera);
  if (is_far_from_filter(sample)) {
    count_refusal(true);
    return PoseEditStatus::kRefused;
  }
  far_in_a_row_ = 0;
  // Errors of neighbouring images are correlated.
  const Vector3 range_sigma = settings_.pose_range_share * sample.relative_eci;
  const Matrix3 covariance =
      4.0 * sample.covariance_eci + range_sigma * range_sigma.transpose() + 1e-4 * Matrix3::Identity();
  filter_.take_position(sample.relative_eci, covariance, own_orbit_.state());
  ++counters_.positions_used;
  last_measurement_ = epoch.time;
  return PoseEditStatus::kPosition;
}

PoseEditStatus PoseNavigation::take_keypoints(const PoseEpoch& epoch, const CameraPose& camera) {
  last_update_ = filter_.take(*epoch.keypoints, camera, own_orbit_.state());
  if (last_update_.usable == 0) return PoseEditStatus::kNone;
  counters_.keypoints_used += last_update_.accepted ? last_update_.used : 0;
  counters_.keypoints_refused += last_update_.usable - (last_update_.accepted ? last_update_.used : 0);
  if (last_update_.accepted) {
    ++counters_.images_used;
    refused_in_a_row_ = 0;
    far_in_a_row_ = 0;
    last_measurement_ = epoch.time;
    return PoseEditStatus::kFilter;
  }
  if (last_update_.is_mostly_rejected(settings_.filter.max_refused_share)) {
    count_refusal(epoch.pnp.has_value() && is_far_from_filter(sample_of(epoch, camera)));
  }
  return PoseEditStatus::kRefused;
}

void PoseNavigation::count_refusal(bool is_position_far) {
  ++counters_.images_refused;
  ++refused_in_a_row_;
  far_in_a_row_ = is_position_far ? far_in_a_row_ + 1 : 0;
  if (far_in_a_row_ >= kFarBeforeRestart || refused_in_a_row_ >= kRefusedBeforeRestart) return restart();
  if (!is_position_far && refused_in_a_row_ >= kRefusedBeforeAttitude && renew_attitude()) {
    inflate_position();
    refused_in_a_row_ = 0;
  }
}

/// A wrong attitude has biased the position as well: keypoints of another side appear larger or smaller.
void PoseNavigation::inflate_position() {
  constexpr double kShare = 0.03;  // of the distance
  const auto seen = filter_.target(own_orbit_.state());
  const auto chief = orbit::qns_from_cartesian(own_orbit_.state());
  if (!seen.ok() || !chief.ok()) return;
  const Vector3 apart = seen.value().position_eci - own_orbit_.state().position_eci;
  filter_.inflate_position(kShare * math::sqrt(apart.squaredNorm()), chief.value().a);
}

void PoseNavigation::restart() {
  ++counters_.restarts;
  filter_.reset();
  refused_in_a_row_ = 0;
  far_in_a_row_ = 0;
  if (has_sample_) static_cast<void>(begin());
}

void PoseNavigation::lose_target() {
  if (!filter_.started()) return;
  ++counters_.restarts;
  filter_.reset();
  start_.clear();
  refused_in_a_row_ = 0;
  far_in_a_row_ = 0;
}

Result<orbit::CartesianState> PoseNavigation::target() const {
  if (!valid()) return Status::kNotReady;
  return filter_.target(own_orbit_.state());
}

Vector6 PoseNavigation::a_roe_m() const {
  const auto servicer = orbit::qns_from_cartesian(own_orbit_.state());
  if (!servicer.ok() || !valid()) return Vector6::Zero();
  return servicer.value().a * filter_.roe();
}

Matrix6 PoseNavigation::a_roe_covariance_m2() const {
  const auto servicer = orbit::qns_from_cartesian(own_orbit_.state());
  if (!servicer.ok() || !valid()) return Matrix6::Zero();
  return servicer.value().a * servicer.value().a * filter_.roe_covariance();
}

/// By the Jacobian of the exact map, from finite differences.
Matrix6 PoseNavigation::covariance_rtn() const {
  constexpr double kDifferenceStep = 1e-7;
  const orbit::CartesianState servicer = own_orbit_.state();
  const auto chief = orbit::qns_from_cartesian(servicer);
  if (!chief.ok() || !valid()) return Matrix6::Zero();
  Matrix6 jacobian;
  for (int k = 0; k < 6; ++k) {
    const auto plus = target_from_roe(chief.value(), filter_.roe() + kDifferenceStep * Vector6::Unit(k));
    const auto minus = target_from_roe(chief.value(), filter_.roe() - kDifferenceStep * Vector6::Unit(k));
    if (!plus.ok() || !minus.ok()) return Matrix6::Zero();
    const auto a = orbit::relative_state_rtn(servicer, plus.value());
    const auto b = orbit::relative_state_rtn(servicer, minus.value());
    jacobian.col(k) << (a.position_rtn - b.position_rtn) / (2.0 * kDifferenceStep),
        (a.velocity_rtn - b.velocity_rtn) / (2.0 * kDifferenceStep);
  }
  return jacobian.lazyProduct(filter_.roe_covariance()).lazyProduct(jacobian.transpose());
}

}  // namespace vbar::fsw::navigation
