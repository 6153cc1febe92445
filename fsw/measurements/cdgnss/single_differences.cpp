#include "fsw/measurements/cdgnss/single_differences.h"

#include "fsw/estimation/unscented.h"
#include "fsw/gnss/ionosphere.h"
#include "fsw/math/math.h"
#include "fsw/orbit/gravity_field.h"
#include "fsw/orbit/roe.h"
#include "fsw/orbit/rtn.h"

namespace vbar::fsw::measurements {

namespace {

// Lock times have a resolution of a fraction of a second and are counted by the receiver clock.
constexpr double kLockTolerance_s = 0.6;
// The longest lock time that the compressed log can represent; it saturates there.
constexpr double kLongestLock_s = 65000.0;

bool fell(double lock_s, double before_s, double elapsed_s) {
  return before_s < kLongestLock_s && lock_s < before_s + elapsed_s - kLockTolerance_s;
}

}  // namespace

std::optional<std::size_t> PhaseChannels::find(gnss::SatelliteId satellite, gnss::Signal signal) const {
  for (std::size_t k = 0; k < channels_.size(); ++k) {
    const PhaseChannel& channel = channels_[k];
    if (channel.in_use && channel.satellite == satellite && channel.signal == signal) return k;
  }
  return std::nullopt;
}

std::optional<std::size_t> PhaseChannels::take(gnss::SatelliteId satellite, gnss::Signal signal) {
  for (std::size_t k = 0; k < channels_.size(); ++k) {
    if (channels_[k].in_use) continue;
    channels_[k] = PhaseChannel{};
    channels_[k].in_use = true;
    channels_[k].satellite = satellite;
    channels_[k].signal = signal;
    return k;
  }
  return std::nullopt;
}

bool PhaseChannels::lost_lock(std::size_t place, const gnss::DifferentialObservation& observation, GpsTime now) const {
  const PhaseChannel& channel = channels_[place];
  if (channel.epochs == 0) return false;
  const double elapsed_s = seconds(now - channel.last_seen);
  return fell(observation.servicer_lock_s, channel.servicer_lock_s, elapsed_s) ||
         fell(observation.target_lock_s, channel.target_lock_s, elapsed_s);
}

void PhaseChannels::see(std::size_t place, const gnss::DifferentialObservation& observation, GpsTime now) {
  PhaseChannel& channel = channels_[place];
  if (channel.epochs == 0) channel.first_seen = now;
  channel.last_seen = now;
  channel.servicer_lock_s = observation.servicer_lock_s;
  channel.target_lock_s = observation.target_lock_s;
  ++channel.epochs;
}

void PhaseChannels::restart(std::size_t place) {
  channels_[place].epochs = 0;
  channels_[place].fixed = false;
}

namespace {

using filter::kAt;

// 7 m: rounding of 1e-9 m and the third derivative both contribute less than 1e-9 of the Jacobian.
constexpr double kDifferenceStep = 1e-6;
// Square root of the trace of the ROE's covariance beyond which the orbit is sampled: 35 m.
constexpr double kSampledSigma = 5e-6;

Result<Vector3> target_at_reception(const orbit::QnsElements& servicer, const Vector6& roe, double clock_m) {
  const auto state = orbit::target_from_roe(servicer, roe);
  if (!state.ok()) return state.status();
  return position_at_reception(state.value(), clock_m);
}

Status differentiate(const orbit::QnsElements& servicer, const Vector6& roe, double clock_m, ReceptionMap& map) {
  const auto middle = target_at_reception(servicer, roe, clock_m);
  if (!middle.ok()) return middle.status();
  map.position_eci = middle.value();
  for (int k = 0; k < 6; ++k) {
    const auto plus = target_at_reception(servicer, roe + kDifferenceStep * Vector6::Unit(k), clock_m);
    const auto minus = target_at_reception(servicer, roe - kDifferenceStep * Vector6::Unit(k), clock_m);
    if (!plus.ok()) return plus.status();
    if (!minus.ok()) return minus.status();
    map.jacobian.col(k) = (plus.value() - minus.value()) / (2.0 * kDifferenceStep);
  }
  return Status::kOk;
}

Status sample(const orbit::QnsElements& servicer, const Vector6& roe, const Matrix6& covariance, double clock_m,
              ReceptionMap& map) {
  using Transform = estimation::UnscentedTransform<6>;
  Transform transform;
  if (const Status status = transform.start(roe, covariance); status != Status::kOk) return status;
  std::array<Vector3, Transform::kPoints> positions;
  for (std::size_t k = 0; k < Transform::kPoints; ++k) {
    const auto position = target_at_reception(servicer, transform.point(k), clock_m);
    if (!position.ok()) return position.status();
    positions[k] = position.value();
  }
  const auto regression = transform.regress<3>(positions);
  map.position_eci = regression.mean;
  map.jacobian = regression.jacobian;
  // Of each column of the factor, the square of a Gaussian: mean d, variance 2 d^2. The regression's own covariance of
  // the nonlinearity is 3.5 times as large with six components, and the first phases would lose their weight.
  constexpr double kSpread2 = 6.0;
  for (std::size_t k = 1; k <= 6; ++k) {
    const Vector3 d = (0.5 * (positions[k] + positions[k + 6]) - positions[0]) / kSpread2;
    map.nonlinearity += (2.0 * d).lazyProduct(d.transpose());
  }
  return Status::kOk;
}

/// Group delay of L1 at `antenna` over the states of the ionosphere, whose gradients are about the servicer's antenna.
Vector3 group_delay_l1(const Matrix3& R_rtn_eci, const Vector3& servicer_antenna, const Vector3& antenna,
                       const Vector3& direction) {
  constexpr double kThousandKilometres_m = 1e6;
  const gnss::ShellCrossing crossing = gnss::shell_crossing(antenna, direction);
  const Vector3 apart_rtn = R_rtn_eci * (antenna + crossing.distance_m * direction - servicer_antenna);
  return crossing.slant_factor *
         Vector3(1.0, apart_rtn.y() / kThousandKilometres_m, apart_rtn.z() / kThousandKilometres_m);
}

/// Index of the code bias, or -1 for GPS L1, which defines the clock.
int code_bias_index(gnss::Signal signal) {
  return signal == gnss::Signal::kGpsL1 ? -1 : kAt<CodeBiases> + static_cast<int>(signal) - 1;
}

}  // namespace

Vector3 position_at_reception(const orbit::CartesianState& at_tag, double clock_m) {
  const double late = -clock_m / gnss::kSpeedOfLight;
  const double distance = at_tag.position_eci.norm();
  const Vector3 gravity = -orbit::kMu / (distance * distance * distance) * at_tag.position_eci;
  return at_tag.position_eci + late * at_tag.velocity_eci + 0.5 * late * late * gravity;
}

Result<ReceptionMap> reception_map(const orbit::CartesianState& servicer, const Vector6& roe, const Matrix6& covariance,
                                   double target_clock_m) {
  const auto chief = orbit::qns_from_cartesian(servicer);
  if (!chief.ok()) return chief.status();
  ReceptionMap map;
  const bool is_sampled = covariance.trace() > kSampledSigma * kSampledSigma;
  const Status status = is_sampled ? sample(chief.value(), roe, covariance, target_clock_m, map)
                                   : differentiate(chief.value(), roe, target_clock_m, map);
  if (status != Status::kOk) return status;
  map.covariance = map.jacobian.lazyProduct(covariance).lazyProduct(map.jacobian.transpose());
  return map;
}

Status DifferenceRows::form(const gnss::DifferentialEpoch& epoch, const AntennaPlatform& servicer,
                            const AntennaPlatform& target, const filter::RelativeNavigationFilter& filter) {
  const filter::Estimate& estimate = filter.estimate();
  const auto map = reception_map(filter.servicer(), filter.roe(), filter.roe_covariance(), target.clock_m);
  if (!map.ok()) return map.status();
  nonlinearity_m_ = math::sqrt(map.value().nonlinearity.trace());
  reference_.roe = filter.roe();
  reference_.servicer_antenna = estimate.mean().segment<3>(kAt<ServicerAntenna>);
  reference_.target_antenna = estimate.mean().segment<3>(kAt<TargetAntenna>);
  reference_.jitter = estimate.mean().segment<3>(kAt<PhaseCentreJitter>);
  reference_.clock = estimate.mean(kAt<ClockDifference>);
  const Vector3 servicer_antenna = position_at_reception(filter.servicer(), servicer.clock_m) +
                                   servicer.R_eci_body * (servicer.antenna_body_m + reference_.servicer_antenna);
  const Vector3 target_antenna = map.value().position_eci + reference_.jitter +
                                 target.R_eci_body * (target.antenna_body_m + reference_.target_antenna);
  const Matrix3 R_rtn_eci = orbit::R_rtn_eci(filter.servicer());
  baseline_m_ = (target_antenna - servicer_antenna).norm();
  for (std::size_t n = 0; n < epoch.count; ++n) {
    const gnss::DifferentialObservation& observation = epoch.observations[n];
    const Vector3 servicer_line = servicer_antenna - observation.servicer_source_eci;
    const Vector3 target_line = target_antenna - observation.target_source_eci;
    const double servicer_range = servicer_line.norm();
    const double target_range = target_line.norm();
    const Vector3 direction = target_line / target_range;
    // Half of the mean square of the position across the line of sight, over the range: curvature of the wave front.
    const Matrix3& covariance = map.value().covariance;
    const double along = direction.dot(covariance * direction);
    const double curvature = 0.5 * (covariance.trace() - along) / target_range;
    Row& row = rows_[n];
    row.predicted = target_range - servicer_range + curvature + reference_.clock;
    row.extra_variance = direction.dot(map.value().nonlinearity * direction) + 2.0 * curvature * curvature;
    row.roe = map.value().jacobian.transpose() * direction;
    row.servicer_antenna = -servicer.R_eci_body.transpose() * (servicer_line / servicer_range);
    row.target_antenna = target.R_eci_body.transpose() * direction;
    row.jitter = direction;
    row.group_delay = group_delay_l1(R_rtn_eci, servicer_antenna, target_antenna, -direction) -
                      group_delay_l1(R_rtn_eci, servicer_antenna, servicer_antenna, -servicer_line / servicer_range);
  }
  return Status::kOk;
}

double DifferenceRows::residual(std::size_t n, double measured_m, const filter::Estimate& estimate) const {
  const Row& row = rows_[n];
  const filter::Estimate::Vector& x = estimate.mean();
  return measured_m - row.predicted - row.roe.dot(x.head<6>() - reference_.roe) -
         row.servicer_antenna.dot(x.segment<3>(kAt<ServicerAntenna>) - reference_.servicer_antenna) -
         row.target_antenna.dot(x.segment<3>(kAt<TargetAntenna>) - reference_.target_antenna) -
         row.jitter.dot(x.segment<3>(kAt<PhaseCentreJitter>) - reference_.jitter) -
         (x(kAt<ClockDifference>) - reference_.clock);
}

double DifferenceRows::code_residual(std::size_t n, const gnss::DifferentialObservation& observation,
                                     const filter::Estimate& estimate) const {
  const int bias = code_bias_index(observation.signal);
  return residual(n, observation.code_m, estimate) - (bias >= 0 ? estimate.mean(bias) : 0.0) -
         group_delay(n, observation.signal).dot(estimate.mean().segment<3>(kAt<Ionosphere>));
}

double DifferenceRows::phase_residual(std::size_t n, std::size_t channel,
                                      const gnss::DifferentialObservation& observation,
                                      const filter::Estimate& estimate) const {
  const int place = static_cast<int>(channel);
  return residual(n, observation.phase_m, estimate) - estimate.mean(kAt<Ambiguities> + place) -
         estimate.mean(kAt<PhaseWander> + place) +
         group_delay(n, observation.signal).dot(estimate.mean().segment<3>(kAt<Ionosphere>));
}

DifferenceRows::Sensitivity DifferenceRows::range_sensitivity(std::size_t n) const {
  const Row& row = rows_[n];
  Sensitivity h = Sensitivity::Zero();
  h.head<6>() = row.roe;
  h.segment<3>(kAt<ServicerAntenna>) = row.servicer_antenna;
  h.segment<3>(kAt<TargetAntenna>) = row.target_antenna;
  h.segment<3>(kAt<PhaseCentreJitter>) = row.jitter;
  h(kAt<ClockDifference>) = 1.0;
  return h;
}

DifferenceRows::Sensitivity DifferenceRows::code_sensitivity(std::size_t n, gnss::Signal signal) const {
  Sensitivity h = range_sensitivity(n);
  if (const int bias = code_bias_index(signal); bias >= 0) h(bias) = 1.0;
  h.segment<3>(kAt<Ionosphere>) = group_delay(n, signal);
  return h;
}

DifferenceRows::Sensitivity DifferenceRows::phase_sensitivity(std::size_t n, std::size_t channel,
                                                              gnss::Signal signal) const {
  Sensitivity h = range_sensitivity(n);
  h(kAt<Ambiguities> + static_cast<int>(channel)) = 1.0;
  h(kAt<PhaseWander> + static_cast<int>(channel)) = 1.0;
  h.segment<3>(kAt<Ionosphere>) = -group_delay(n, signal);
  return h;
}

/// Group delay of the difference, proportional to the square of the wavelength.
Vector3 DifferenceRows::group_delay(std::size_t n, gnss::Signal signal) const {
  const double ratio = gnss::wavelength(signal) / gnss::wavelength(gnss::Signal::kGpsL1);
  return ratio * ratio * rows_[n].group_delay;
}

}  // namespace vbar::fsw::measurements
