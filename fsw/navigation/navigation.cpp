#include "fsw/navigation/navigation.h"

#include <algorithm>
#include <span>

#include "fsw/filter/propagation.h"
#include "fsw/math/math.h"
#include "fsw/messaging/message_fields.h"
#include "fsw/orbit/finite_burn.h"
#include "fsw/orbit/propagate.h"
#include "fsw/orbit/roe.h"
#include "fsw/orbit/rtn.h"

namespace vbar::fsw::navigation {
namespace {

// Relative acceleration not modelled by point mass and J2, per metre of separation: the gravity gradient of all other
// harmonics is a tenth of an Eotvos at 700 km. (Flown in 60x60 gravity, ten-minute coasts err by 0.7 to 1 of this, from
// 75 km down to 7 m.)
constexpr double kUnmodelledGradient = 1e-10;  // 1/s^2, 1 sigma, constant over a coast

// The state is valid for planning unless the target may be anywhere about its distance, now or soon: by covariance, not
// by elapsed time.
constexpr double kMaxRelativeSigma = 0.25;  // of the separation
constexpr double kAlwaysAccurate_m = 0.5;
constexpr double kSoon_s = 300.0;

// Largest delay of a report or measurement with respect to its time tag.
constexpr Duration kLongestDelay = duration_of_seconds(600);

// GNSS navigation lags its newest measurement by the delay of the crosslink; an older state counts as propagated.
constexpr double kFreshGnss_s = 30.0;

bool is_orbit(const orbit::CartesianState& state) {
  return orbit::qns_from_cartesian(state).ok();
}

/// Returns 1 sigma of the differential acceleration of the target, m/s^2, of all axes.
double differential_acceleration_sigma(const filter::Estimate& estimate) {
  double variance = 0.0;
  for (int k = filter::kAt<filter::DifferentialAccelerations>; k < filter::kOrbitSize; ++k) {
    variance += estimate.covariance(k, k);
  }
  return math::sqrt(variance);
}

}  // namespace

void NavigationSolution::update(GpsTime now, const messaging::Telecommands& telecommands, messaging::Inbox& inbox,
                                MeasurementScheduler& measurements) {
  configure(telecommands);
  measurements.configure(now, telecommands);
  take_maneuvers(now, inbox);
  measurements.update(now, inbox, own_burns());
  adopt_estimate(measurements);
  if (!has_reference_) return;
  if (now - reference_.epoch > kLongestDelay + kLongestDelay) move_reference(now - kLongestDelay);

  const Result<Pair> present = flown_to(now);
  if (!present.ok()) {
    drop_state();  // gap too long, or invalid orbit: restart from the next measurement
    return;
  }
  state_.valid = measurements.valid();
  state_.has_target = true;
  state_.epoch = now;
  state_.servicer = present.value().servicer;
  state_.target = present.value().target;
  state_.source = source_of(now, measurements);
  set_uncertainty(now, measurements.filter());
}

void NavigationSolution::drop_state() {
  has_reference_ = false;
  state_.valid = false;
  state_.has_target = false;
}

/// Returns the source of the newest measurement, or the most accurate one of several.
NavigationSource NavigationSolution::source_of(GpsTime now, const MeasurementScheduler& measurements) const {
  if (measurements.uses<measurements::IdealSource>() && state_.last_measurement == now) return NavigationSource::kIdeal;
  const auto& carrier = measurements.source<measurements::CdgnssSource>();
  if (carrier.aid().is_on() && seconds(now - carrier.last_measurement()) <= kFreshGnss_s) {
    return carrier.is_fixed() ? NavigationSource::kGnssFixed : NavigationSource::kGnssFloat;
  }
  const auto& keypoints = measurements.source<measurements::KeypointSource>();
  if (keypoints.aid().is_on() && keypoints.has_aided()) return NavigationSource::kPose;
  const auto& bearings = measurements.source<measurements::BearingSource>();
  const bool is_newest = bearings.last_measurement() == state_.last_measurement;
  if (bearings.aid().is_on() && bearings.has_aided() && is_newest) return NavigationSource::kAnglesOnly;
  return NavigationSource::kPropagated;
}

/// Propagates the covariance of position and velocity from the estimator's epoch, including the unmodelled acceleration
/// and the differential one, known to its sigma.
void NavigationSolution::set_uncertainty(GpsTime now, const filter::RelativeNavigationFilter& filter) {
  const Matrix6 covariance_rtn = filter::covariance_rtn(filter.estimate(), filter.servicer());
  const double coast_s = seconds(now - filter.epoch());
  const double separation = (state_.target.position_eci - state_.servicer.position_eci).norm();
  const double acceleration =
      math::hypot(kUnmodelledGradient * separation, differential_acceleration_sigma(filter.estimate()));
  for (int axis = 0; axis < 3; ++axis) {
    const double position = math::sqrt(covariance_rtn(axis, axis));
    const double velocity = math::sqrt(covariance_rtn(3 + axis, 3 + axis));
    state_.sigma_rtn(axis) = math::hypot(position + velocity * coast_s, 0.5 * acceleration * coast_s * coast_s);
    state_.sigma_rtn(3 + axis) = math::hypot(velocity, acceleration * coast_s);
  }
  const double largest =
      math::hypot(state_.sigma_rtn.head<3>().maxCoeff(), kSoon_s * state_.sigma_rtn.tail<3>().maxCoeff());
  if (!(largest < kMaxRelativeSigma * separation + kAlwaysAccurate_m)) state_.valid = false;
}

/// Discards the state if its sources or the a-priori orbit are commanded: the next estimate of the filter, which may be
/// the present one, becomes the reference state.
void NavigationSolution::configure(const messaging::Telecommands& telecommands) {
  if (telecommands.is_new<thruster_configuration>()) {
    thrust_acceleration_ = telecommands.in_force<thruster_configuration>()->thrust_acceleration;
  }
  if (telecommands.is_new<navigation_configuration>()) {
    constexpr std::int32_t kCamera = measurements::BearingSource::kUse | measurements::KeypointSource::kUse;
    uses_camera_ = (telecommands.in_force<navigation_configuration>()->sources & kCamera) != 0;
    drop_state();
  }
  if (!telecommands.is_new<target_apriori>()) return;
  drop_state();
  const bool is_handed_over = telecommands.in_force<target_apriori>()->kind == target_apriori::kKindRoe;
  handed_over_ = is_handed_over ? telecommands.time_of<target_apriori>() : GpsTime{};
}

filter::Burn NavigationSolution::burn_of(std::int32_t maneuver_id, GpsTime time, const Vector3& dv_rtn) const {
  return {.time = time,
          .dv_rtn = dv_rtn,
          .duration = orbit::burn_duration(dv_rtn.norm(), thrust_acceleration_),
          .maneuver_id = maneuver_id};
}

/// Adopts an estimate as the reference state if it is later than the current one.
void NavigationSolution::set_reference(const Pair& estimated) {
  if (!is_orbit(estimated.servicer) || !is_orbit(estimated.target)) return;
  if (has_reference_ && estimated.epoch <= reference_.epoch) return;
  reference_ = estimated;
  has_reference_ = true;
  discard_before(estimated.epoch);
}

void NavigationSolution::adopt_estimate(const MeasurementScheduler& measurements) {
  const filter::RelativeNavigationFilter& filter = measurements.filter();
  const Result<orbit::CartesianState> target = filter.target();
  if (!target.ok()) return drop_state();
  state_.last_measurement = std::max(measurements.last_measurement(), handed_over_);
  set_reference({filter.epoch(), filter.servicer(), target.value()});
}

void NavigationSolution::take_maneuvers(GpsTime now, messaging::Inbox& inbox) {
  const auto& reports = inbox.queue<vbar::executed_maneuver>();
  for (std::size_t k = 0; k < reports.size(); ++k) {
    const GpsTime time = reports[k].tag.time;
    const executed_maneuver& report = reports[k].value;
    // A burn that lasts is refused at its begin, before its time.
    const bool is_early_refusal = report.accepted == 0 && thrust_acceleration_ > 0.0;
    if (time > now && !is_early_refusal) {
      inbox.count_unusable_time();
      continue;
    }
    take_report(time, report, inbox);
  }
}

/// A measurement within a burn leaves a reference state that holds a part of it, as commanded.
void NavigationSolution::take_report(GpsTime time, const executed_maneuver& report, messaging::Inbox& inbox) {
  const bool is_accepted = report.accepted != 0;
  filter::Burn burn = burn_of(report.maneuver_id, time, messaging::vector(report.dv_rtn));
  std::size_t k = 0;
  while (k < maneuver_count_ && maneuvers_[k].maneuver_id != burn.maneuver_id) ++k;
  const bool is_commanded = k < maneuver_count_ && maneuvers_[k].lasts();
  const bool is_under_way = is_commanded && has_reference_ && maneuvers_[k].begin() < reference_.epoch;
  if (is_under_way) {
    if (!is_accepted) burn.dv_rtn.setZero();
    burn.duration = maneuvers_[k].duration;
    burn = filter::as_reported(maneuvers_[k], burn, reference_.epoch);
  }
  discard(report.maneuver_id);
  if (!is_accepted && !is_under_way) return;
  if (!has_reference_ || burn.acts_on(reference_.epoch)) {
    remember(burn);
  } else if (time >= state_.last_measurement) {
    inbox.count_unusable_time();  // before the reference state: no longer applicable
  }
}

void NavigationSolution::expect_maneuver(std::int32_t maneuver_id, GpsTime time, const Vector3& dv_rtn) {
  remember(burn_of(maneuver_id, time, dv_rtn));
}

/// Moves the reference state to `time`: without measurements it follows, so that the work of a step stays bounded.
void NavigationSolution::move_reference(GpsTime time) {
  const Result<Pair> moved = flown_to(time);
  has_reference_ = moved.ok();
  if (!has_reference_) return;
  reference_ = moved.value();
  discard_before(time);
}

/// Returns the reference states propagated to `time`, with the servicer's maneuvers before it.
Result<NavigationSolution::Pair> NavigationSolution::flown_to(GpsTime time) const {
  orbit::CartesianState servicer = reference_.servicer;
  GpsTime reached = reference_.epoch;
  const auto coast_to = [&](GpsTime next) {
    const Result<orbit::CartesianState> later = coasted(servicer, reached, next);
    if (later.ok()) servicer = later.value();
    reached = next;
    return later.status();
  };
  for (std::size_t k = 0; k < maneuver_count_ && maneuvers_[k].time < time; ++k) {
    if (maneuvers_[k].lasts()) continue;
    if (const Status status = coast_to(maneuvers_[k].time); status != Status::kOk) return status;
    servicer = orbit::apply_impulse_rtn(servicer, maneuvers_[k].dv_rtn);
  }
  if (const Status status = coast_to(time); status != Status::kOk) return status;
  const Result<orbit::CartesianState> target = orbit::propagate_j2(reference_.target, seconds(time - reference_.epoch));
  if (!target.ok()) return target.status();
  if (!is_orbit(servicer) || !is_orbit(target.value())) return Status::kOutOfRange;
  return Pair{time, servicer, target.value()};
}

/// Returns the state at `to`, with the burns that last.
Result<orbit::CartesianState> NavigationSolution::coasted(const orbit::CartesianState& servicer, GpsTime from,
                                                          GpsTime to) const {
  orbit::CartesianState state = servicer;
  GpsTime reached = from;
  for (std::size_t arc = 0; arc <= 2 * kMaxManeuvers; ++arc) {
    const GpsTime next = filter::next_edge(own_burns(), reached, to);
    const filter::Thrust thrust = filter::thrust_from(own_burns(), reached);
    if (thrust.is_on) {
      state = filter::propagate_accelerated(state, thrust.acceleration_rtn, seconds(next - reached));
    } else {
      const Result<orbit::CartesianState> later = orbit::propagate_j2(state, seconds(next - reached));
      if (!later.ok()) return later;
      state = later.value();
    }
    reached = next;
    if (reached >= to) break;
  }
  return state;
}

/// Inserts a maneuver in order of time, those of one instant in order of their number. If the list is full, the
/// reference state advances past the oldest maneuver: measurements before it can then no longer be used.
void NavigationSolution::remember(const filter::Burn& maneuver) {
  if (maneuver_count_ == kMaxManeuvers) {
    if (has_reference_) move_reference(maneuvers_[0].end() + Duration{1});
    if (maneuver_count_ == kMaxManeuvers) discard(maneuvers_[0].maneuver_id);
  }
  std::size_t place = maneuver_count_++;
  const auto comes_before = [&](const filter::Burn& other) {
    return maneuver.time < other.time || (maneuver.time == other.time && maneuver.maneuver_id < other.maneuver_id);
  };
  for (; place > 0 && comes_before(maneuvers_[place - 1]); --place) maneuvers_[place] = maneuvers_[place - 1];
  maneuvers_[place] = maneuver;
}

void NavigationSolution::discard(std::int64_t maneuver_id) {
  std::size_t kept = 0;
  for (std::size_t k = 0; k < maneuver_count_; ++k) {
    if (maneuvers_[k].maneuver_id != maneuver_id) maneuvers_[kept++] = maneuvers_[k];
  }
  maneuver_count_ = kept;
}

void NavigationSolution::discard_before(GpsTime time) {
  std::size_t kept = 0;
  for (std::size_t k = 0; k < maneuver_count_; ++k) {
    if (maneuvers_[k].acts_on(time)) maneuvers_[kept++] = maneuvers_[k];
  }
  maneuver_count_ = kept;
}

/// The sigma at the epoch of the filter grows by the drift of the mean longitude and by the differential acceleration
/// until the state (a velocity v changes the elements by at most 2 v / n).
Vector6 NavigationSolution::sigma_a_roe_m(const filter::RelativeNavigationFilter& filter) const {
  const Matrix6 covariance = filter.a_roe_covariance_m2();
  Vector6 sigma;
  for (int k = 0; k < 6; ++k) sigma(k) = math::sqrt(covariance(k, k));
  const auto servicer = orbit::qns_from_cartesian(state_.servicer);
  if (!servicer.ok()) return sigma;
  const double n = orbit::mean_motion(servicer.value().a);
  const double coast_s = seconds(state_.epoch - filter.epoch());
  const double changed = 2.0 / n * differential_acceleration_sigma(filter.estimate()) * coast_s;
  sigma(1) += 1.5 * n * coast_s * sigma(0);
  for (int k = 0; k < 6; ++k) sigma(k) = math::hypot(sigma(k), changed);
  return sigma;
}

Matrix6 NavigationSolution::a_roe_covariance_m2(const filter::RelativeNavigationFilter& filter) const {
  const Matrix6 covariance = filter.a_roe_covariance_m2();
  const auto servicer = orbit::qns_from_cartesian(state_.servicer);
  if (!servicer.ok()) return covariance;
  const double coast_s = seconds(state_.epoch - filter.epoch());
  const double changed =
      2.0 / orbit::mean_motion(servicer.value().a) * differential_acceleration_sigma(filter.estimate()) * coast_s;
  const Matrix6 transition = orbit::roe_transition_j2(servicer.value(), coast_s);
  return transition * covariance * transition.transpose() + changed * changed * Matrix6::Identity();
}

}  // namespace vbar::fsw::navigation
