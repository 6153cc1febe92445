#include "fsw/filter/relative_navigation_filter.h"

#include <algorithm>

#include "fsw/orbit/rtn.h"
#include "fsw/orbit/sun.h"

namespace vbar::fsw::filter {
namespace {

// Propagation interval of one Earth orientation and Sun direction; shorter with the attitude, whose gravity gradient is
// constant over it.
constexpr Duration kSegment = duration_of_seconds(600);
constexpr Duration kAttitudeSegment = duration_of_seconds(20);
constexpr int kMaxSegments = 10000;

// Sigmas of states taken from ideal navigation are far below those of any sensor.
constexpr double kKnownSigma_m = 1e-5;
constexpr double kKnownSigma_mps = 1e-8;

// 1 sigma of the velocity of a converged absolute orbit is below this.
constexpr double kConvergedVelocity = 0.02;  // m/s

constexpr double square(double x) {
  return x * x;
}

}  // namespace

void RelativeNavigationFilter::configure(const FilterSettings& settings) {
  settings_ = settings;
  absolute_orbit_.configure(settings.absolute_orbit);
  relative_orbit_.configure(settings.relative_orbit);
  attitude_.configure(settings.attitude);
}

void RelativeNavigationFilter::set_apriori(const TargetApriori& apriori) {
  apriori_ = Apriori(apriori);
  if (solution_status_ <= SolutionStatus::kApriori) refer_to_apriori();
}

void RelativeNavigationFilter::advance_to(GpsTime time, std::span<const filter::Burn> burns) {
  if (!absolute_orbit_.started()) {
    if (solution_status_ != SolutionStatus::kNone)
      fail_relative();  // it cannot be propagated without the servicer's orbit
    epoch_ = time;
    return;
  }
  for (const filter::Burn& burn : burns) {
    if (burn.lasts() || burn.time < epoch_) continue;
    if (burn.time >= time) break;
    coast_to(burn.time, burns);
    add_impulse(burn.dv_rtn);
  }
  coast_to(time, burns);
}

void RelativeNavigationFilter::coast_to(GpsTime time, std::span<const filter::Burn> burns) {
  const Duration longest = has_attitude() ? kAttitudeSegment : kSegment;
  for (int segment = 0; segment < kMaxSegments && epoch_ < time; ++segment) {
    const GpsTime next = next_edge(burns, epoch_, time - epoch_ > longest ? epoch_ + longest : time);
    const filter::Propagation propagation(epoch_, settings_.earth, orbit::sun_position_gcrf(epoch_).normalized());
    const OrbitStep step{.propagation = propagation,
                         .servicer = servicer(),
                         .dt = seconds(next - epoch_),
                         .thrust = thrust_from(burns, epoch_, settings_.burn_errors())};
    if (solution_status_ != SolutionStatus::kNone) advance_relative(step);
    absolute_orbit_.advance(propagation, step.dt, step.thrust);
    epoch_ = next;
    if (!absolute_orbit_.started()) {
      epoch_ = time;
      return;
    }
    if (step.thrust.is_on) note_thrust(step);
  }
}

void RelativeNavigationFilter::advance_relative(const OrbitStep& step) {
  motion_.mean = estimate_.mean().head<kHeadSize>();
  motion_.jacobian.setIdentity();
  motion_.noise.setZero();
  if (!relative_orbit_.advance(estimate_, step, motion_)) return fail_relative();
  if (!attitude_.advance(estimate_, step, motion_)) deactivate_attitude();
  estimate_.transform_head<kHeadSize>(motion_.mean, motion_.jacobian, motion_.noise);
  const double rate = math::sqrt(estimate_.mean().segment<3>(kAt<Rate>).squaredNorm());
  const estimation::BlockStep block_step{.dt_s = step.dt, .target_rate = rate};
  MeasurementBlocks::for_each([&]<class Block>() {
    estimation::propagate_block<State, Block>(estimate_, settings_.processes, adaptations_, block_step);
  });
  finish_update();
}

void RelativeNavigationFilter::add_impulse(const Vector3& dv_rtn) {
  const orbit::CartesianState before = servicer();
  const Vector3 dv_eci = orbit::R_rtn_eci(before).transpose() * dv_rtn;
  const double sigma = settings_.burn_errors().of(dv_eci);
  if (solution_status_ != SolutionStatus::kNone && !relative_orbit_.impulse(estimate_, before, dv_eci, sigma)) {
    fail_relative();
  }
  absolute_orbit_.add_impulse(dv_eci, sigma);
  note_impulse({epoch_, dv_eci, dv_rtn});
}

/// Its direction is the mean of those at both ends of the step.
void RelativeNavigationFilter::note_thrust(const OrbitStep& step) {
  relative_orbit_.noise().interrupt();
  const Vector3 dv_rtn = step.dt * step.thrust.acceleration_rtn;
  const Matrix3 R_eci_rtn =
      0.5 * (orbit::R_rtn_eci(step.servicer).transpose() + orbit::R_rtn_eci(servicer()).transpose());
  note_impulse({epoch_ - nearest_duration(0.5 * step.dt), R_eci_rtn * dv_rtn, dv_rtn});
}

void RelativeNavigationFilter::note_impulse(const Impulse& impulse) {
  if (impulse_count_ == kMaxImpulses) {
    --impulse_count_;
    for (std::size_t k = 0; k < impulse_count_; ++k) impulses_[k] = impulses_[k + 1];
  }
  impulses_[impulse_count_++] = impulse;
}

bool RelativeNavigationFilter::update_absolute_orbit(const AbsolutePosition& position) {
  const orbit::CartesianState before = servicer();
  const Result<orbit::CartesianState> target_before = target();
  const double velocity_variance = absolute_orbit_.covariance().diagonal().tail<3>().sum();
  const bool is_accepted = absolute_orbit_.process(epoch_, position);
  if (solution_status_ <= SolutionStatus::kApriori) {
    refer_to_apriori();
  } else if (is_accepted && target_before.ok() && velocity_variance > square(kConvergedVelocity)) {
    keep_relative_state(before, target_before.value());
  }
  return is_accepted;
}

/// Keeps the inertial relative state: while the absolute orbit converges, its corrections move the target by as much in
/// inertial axes, in which the sensors measure: constant elements would turn the relative position with the direction
/// of the servicer's velocity, by ten centimetres at a kilometre. Afterwards the elements stay: they hold the drift of
/// many orbits, and two orbits that are moved alike 70 km apart drift apart by metres.
void RelativeNavigationFilter::keep_relative_state(const orbit::CartesianState& servicer_before,
                                                   const orbit::CartesianState& target_before) {
  const orbit::CartesianState now = servicer();
  const orbit::CartesianState moved{
      .position_eci = now.position_eci + (target_before.position_eci - servicer_before.position_eci),
      .velocity_eci = now.velocity_eci + (target_before.velocity_eci - servicer_before.velocity_eci)};
  const auto roe_now = roe_of_target(now, moved);
  if (!roe_now.ok()) return;
  for (int k = 0; k < Roe::kSize; ++k) estimate_.shift(k, roe_now.value()(k) - estimate_.mean(k));
}

void RelativeNavigationFilter::set_states(const orbit::CartesianState& servicer, const orbit::CartesianState& target) {
  const auto chief = orbit::qns_from_cartesian(servicer);
  const auto roe = roe_of_target(servicer, target);
  if (!chief.ok() || !roe.ok()) return;
  absolute_orbit_.initialize(servicer, kKnownSigma_m, kKnownSigma_mps);
  const double velocity_scale = kKnownSigma_mps / orbit::mean_motion(chief.value().a);
  const double sigma = (kKnownSigma_m + velocity_scale) / chief.value().a;
  initialize_relative(roe.value(), square(sigma) * Matrix6::Identity(), SolutionStatus::kEstimated);
}

/// An absolute a-priori orbit is referred to the servicer again with each of its positions, as long as nothing else is
/// known: the servicer's absolute orbit is not accurate at first.
void RelativeNavigationFilter::refer_to_apriori() {
  if (!apriori_ || !absolute_orbit_.started()) return;
  const auto known = apriori_->at(epoch_, absolute_orbit_, settings_.earth);
  if (!known.ok()) return;
  const bool is_handed_over = apriori_->known().kind == TargetApriori::Kind::kMeanRoe;
  initialize_relative(known.value().roe, known.value().covariance,
                      is_handed_over ? SolutionStatus::kEstimated : SolutionStatus::kApriori);
}

void RelativeNavigationFilter::initialize_relative(const Vector6& roe, const Matrix6& covariance,
                                                   SolutionStatus solution_status) {
  relative_orbit_.initialize(estimate_, roe, covariance);
  solution_status_ = solution_status;
  finish_update();
}

Result<orbit::CartesianState> RelativeNavigationFilter::target() const {
  if (!has_relative()) return Status::kNotReady;
  const auto chief = orbit::qns_from_cartesian(servicer());
  if (!chief.ok()) return chief.status();
  return target_from_roe(chief.value(), roe());
}

Vector6 RelativeNavigationFilter::a_roe_m() const {
  const auto chief = orbit::qns_from_cartesian(servicer());
  return chief.ok() && has_relative() ? Vector6(chief.value().a * roe()) : Vector6(Vector6::Zero());
}

Matrix6 RelativeNavigationFilter::a_roe_covariance_m2() const {
  const auto chief = orbit::qns_from_cartesian(servicer());
  return chief.ok() && has_relative() ? Matrix6(square(chief.value().a) * roe_covariance()) : Matrix6(Matrix6::Zero());
}

Matrix3 RelativeNavigationFilter::position_covariance_eci() const {
  if (!has_relative()) return Matrix3::Zero();
  const Matrix3 R_rtn_eci = orbit::R_rtn_eci(servicer());
  const Matrix3 rtn = covariance_rtn(estimate_, servicer()).topLeftCorner<3, 3>();
  return R_rtn_eci.transpose() * rtn * R_rtn_eci;
}

void RelativeNavigationFilter::initialize_attitude(const filter::AttitudeState& attitude, const Matrix6& covariance) {
  attitude_.initialize(estimate_, attitude, covariance);
  MeasurementBlocks::for_each([&]<class Block>() {
    if constexpr (estimation::IsInitializedWithAttitude<Block, State>) {
      Block::template initialize_with_attitude<State>(estimate_, settings_.processes.template of<Block>());
    }
  });
  finish_update();
}

void RelativeNavigationFilter::deactivate_attitude() {
  MeasurementBlocks::for_each([&]<class Block>() {
    if constexpr (estimation::FollowsAttitude<Block>) deactivate_block<Block>(estimate_);
  });
  attitude_.deactivate(estimate_);
}

bool RelativeNavigationFilter::update(const MeasurementSource& source, MeasurementBatch& batch) {
  if (!estimation::update(estimate_, batch)) return false;
  finish_update();
  if (source.confirms_orbit) confirm_relative(source);
  return true;
}

void RelativeNavigationFilter::finish_update() {
  attitude_.reset_attitude_error(estimate_);
  if (!estimate_.is_sound()) fail_relative();
}

bool RelativeNavigationFilter::is_confirmed_by_others(const MeasurementSource& source) const {
  for (std::size_t place = 0; place < kMaxSources; ++place) {
    const auto& confirmed = confirmed_[place];
    if (place != source.place() && confirmed && epoch_ - *confirmed <= kConfirmation) return true;
  }
  return false;
}

bool RelativeNavigationFilter::is_precisely_determined() const {
  bool is_determined = false;
  MeasurementBlocks::for_each([&]<class Block>() {
    if constexpr (estimation::DeterminesOrbit<Block>) is_determined = is_determined || is_active<Block>(estimate_);
  });
  return is_determined;
}

void RelativeNavigationFilter::inflate_relative(double velocity_sigma, double along_track_sigma_m) {
  const auto chief = orbit::qns_from_cartesian(servicer());
  if (!chief.ok() || !has_relative()) return;
  relative_orbit_.inflate(estimate_, servicer(), velocity_sigma, along_track_sigma_m / chief.value().a);
}

void RelativeNavigationFilter::inflate_by_burn(GpsTime since, double velocity_sigma) {
  constexpr double kShortest_s = 1e-3, kLongest_s = 6000.0;
  if (!has_relative() || !(velocity_sigma > 0.0)) return;
  const double dt = std::clamp(seconds(epoch_ - since), kShortest_s, kLongest_s);
  relative_orbit_.inflate_by_burn(estimate_, servicer(), velocity_sigma, dt);
  finish_update();
}

void RelativeNavigationFilter::scale_relative_covariance(double factor) {
  if (!has_relative() || !(factor > 1.0)) return;
  estimate_.transform_head<6>(roe(), Matrix6::Identity(), (factor - 1.0) * roe_covariance());
  finish_update();
}

void RelativeNavigationFilter::inflate_absolute_orbit(double velocity_sigma) {
  absolute_orbit_.add_impulse(Vector3::Zero(), velocity_sigma);
}

void RelativeNavigationFilter::fail_relative() {
  ++failures_;
  solution_status_ = SolutionStatus::kNone;
  for (int k = State::kSize; k-- > 0;) estimate_.reset(k, 0.0, 0.0);
}

}  // namespace vbar::fsw::filter
