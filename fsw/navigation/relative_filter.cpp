#include "fsw/navigation/relative_filter.h"

#include "fsw/estimation/unscented.h"
#include "fsw/math/math.h"
#include "fsw/navigation/dynamics.h"
#include "fsw/orbit/constants.h"
#include "fsw/orbit/rtn.h"

namespace vbar::fsw::navigation {
namespace {

using Filter = RelativeFilter;

constexpr int kPosition = 0;
constexpr int kVelocity = 3;
constexpr int kAcceleration = Filter::State::offset<Filter::EmpiricalAcceleration>();
constexpr int kServicerAntenna = Filter::State::offset<Filter::ServicerAntenna>();
constexpr int kTargetAntenna = Filter::State::offset<Filter::TargetAntenna>();
constexpr int kJitter = Filter::State::offset<Filter::PhaseCentreJitter>();
constexpr int kClock = Filter::State::offset<Filter::ClockDifference>();
constexpr int kCodeBias = Filter::State::offset<Filter::CodeBiases>();

constexpr double kGate = 25.0;  // 5 sigma, one degree of freedom
constexpr double kNoGate = 1e300;

// The clock difference of single-point solutions is wrong by some metres; this sigma gives it negligible weight.
constexpr double kClockSigma_m = 100.0;
// Likewise for an ambiguity that is initialised from its own first measurement.
constexpr double kAmbiguitySigma_m = 30.0;

// In addition to the correlated acceleration: keeps the velocity covariance from collapsing, m^2/s^3.
constexpr double kVelocityPsd = 1e-18;

// A phase that differs by this from the others of the epoch, in addition to the uncertainty of the filter, has slipped.
constexpr double kSlip_m = 0.03;
constexpr double kSlipSigmas = 5.0;
constexpr std::size_t kMinForMedian = 5;

/// Position of the receiver antenna when its signals arrived: the tag is that of its own clock.
Vector3 antenna_position(const ReceiverPlatform& platform, const orbit::CartesianState& state) {
  const double late = -platform.clock_m / gnss::kSpeedOfLight;
  const double distance = state.position_eci.norm();
  const Vector3 gravity = -orbit::kMu / (distance * distance * distance) * state.position_eci;
  return state.position_eci + late * state.velocity_eci + 0.5 * late * late * gravity +
         platform.R_eci_body * platform.antenna_body_m;
}

/// Index of the code bias, or -1 for GPS L1, which defines the clock.
int code_bias_index(gnss::Signal signal) {
  return signal == gnss::Signal::kGpsL1 ? -1 : kCodeBias + static_cast<int>(signal) - 1;
}

/// Residuals in order of size.
struct Residual {
  std::size_t observation = 0;
  double value = 0.0;
};
struct Residuals {
  std::array<Residual, gnss::kMaxObservations> sorted{};
  std::size_t count = 0;

  void add(const Residual& residual) {
    std::size_t place = count++;
    for (; place > 0 && sorted[place - 1].value > residual.value; --place) sorted[place] = sorted[place - 1];
    sorted[place] = residual;
  }
  [[nodiscard]] const Residual& median() const { return sorted[count / 2]; }
};

}  // namespace

void RelativeFilter::reset() {
  started_ = false;
  channels_.clear();
  for (int i = 0; i < State::kSize; ++i) estimate_.reset(i, 0.0, 0.0);
}

void RelativeFilter::begin(GpsTime time, const Vector3& position_eci, double sigma_m, double mean_motion) {
  reset();
  const auto square = [](double x) { return x * x; };
  const double velocity_sigma = settings_.start_velocity_sigma + 2.0 * mean_motion * (position_eci.norm() + sigma_m);
  for (int axis = 0; axis < 3; ++axis) {
    estimate_.reset(kPosition + axis, position_eci(axis), square(sigma_m));
    estimate_.reset(kVelocity + axis, 0.0, square(velocity_sigma));
    estimate_.reset(kAcceleration + axis, 0.0, square(settings_.acceleration_sigma));
    estimate_.reset(kServicerAntenna + axis, 0.0, square(settings_.antenna_offset_sigma_m));
    estimate_.reset(kTargetAntenna + axis, 0.0, square(settings_.antenna_offset_sigma_m));
    estimate_.reset(kCodeBias + axis, 0.0, square(settings_.code_bias_sigma_m));
  }
  epoch_ = time;
  started_ = true;
}

void RelativeFilter::advance_to(GpsTime time, const orbit::CartesianState& servicer) {
  const double dt = seconds(time - epoch_);
  if (!started_ || dt <= 0.0) return;
  using Transform = estimation::UnscentedTransform<kHead>;
  using Head = Transform::Vector;
  Transform transform;
  if (transform.start(estimate_.mean().head<kHead>(), estimate_.head_covariance<kHead>()) != Status::kOk) {
    reset();
    return;
  }
  const double decay = math::exp(-dt / settings_.acceleration_time_s);
  const orbit::CartesianState servicer_later = propagate_accelerated(servicer, Vector3::Zero(), dt);
  std::array<Head, Transform::kPoints> moved;
  for (std::size_t k = 0; k < Transform::kPoints; ++k) {
    const Head x = transform.point(k);
    const orbit::CartesianState target{.position_eci = servicer.position_eci + x.segment<3>(kPosition),
                                       .velocity_eci = servicer.velocity_eci + x.segment<3>(kVelocity)};
    const orbit::CartesianState later = propagate_accelerated(target, x.segment<3>(kAcceleration), dt);
    moved[k] << later.position_eci - servicer_later.position_eci, later.velocity_eci - servicer_later.velocity_eci,
        decay * x.segment<3>(kAcceleration);
  }
  const auto regression = transform.regress<kHead>(moved);
  Transform::Matrix noise = regression.nonlinearity;
  const double acceleration_variance = settings_.acceleration_sigma * settings_.acceleration_sigma;
  add_acceleration_noise(noise, kVelocityPsd, dt);
  for (int axis = 0; axis < 3; ++axis) {
    noise(kAcceleration + axis, kAcceleration + axis) += (1.0 - decay * decay) * acceleration_variance;
  }
  estimate_.transform_head<kHead>(regression.mean, regression.jacobian, noise);
  advance_wander(dt);
  epoch_ = time;
  if (!estimate_.is_sound()) reset();
}

/// Gauss-Markov decay; the variance tends to that of a difference of two receivers.
void RelativeFilter::advance_wander(double dt) {
  if (settings_.phase_wander_sigma_m == 0.0) return;
  const double decay = math::exp(-dt / settings_.phase_wander_time_s);
  const double variance = 2.0 * settings_.phase_wander_sigma_m * settings_.phase_wander_sigma_m;
  for (std::size_t place = 0; place < kPhaseChannels; ++place) {
    const int index = wander_index(place);
    if (estimate_.is_idle(index)) continue;
    estimate_.scale(index, decay);
    estimate_.add_noise(index, (1.0 - decay * decay) * variance);
  }
}

void RelativeFilter::add_servicer_impulse(const Vector3& dv_eci) {
  const double sigma = settings_.maneuver_sigma + settings_.maneuver_sigma_relative * dv_eci.norm();
  for (int axis = 0; axis < 3; ++axis) {
    estimate_.shift(kVelocity + axis, -dv_eci(axis));
    estimate_.add_noise(kVelocity + axis, sigma * sigma);
  }
}

RelativeUpdate RelativeFilter::take(const DifferentialEpoch& epoch, const ReceiverPlatform& servicer,
                                    const ReceiverPlatform& target) {
  RelativeUpdate update;
  if (!started_ || epoch.count == 0) return update;
  channels_.give_back_unseen(epoch.time, [this](std::size_t place) { deactivate(place); });
  renew_epoch_states(servicer, target);
  if (linearise(epoch, servicer, target) != Status::kOk) {
    reset();
    return update;
  }
  find_outlying_codes(epoch);
  use_codes(epoch, update);
  follow_channels(epoch, update);
  find_slips_by_median(epoch, update);
  use_phases(epoch, update);
  if (!estimate_.is_sound()) reset();
  return update;
}

/// Clocks and jitter are independent of the previous epoch.
void RelativeFilter::renew_epoch_states(const ReceiverPlatform& servicer, const ReceiverPlatform& target) {
  estimate_.reset(kClock, target.clock_m - servicer.clock_m, kClockSigma_m * kClockSigma_m);
  const double jitter_variance = 2.0 * settings_.phase_centre_jitter_m * settings_.phase_centre_jitter_m;
  for (int axis = 0; axis < 3; ++axis) estimate_.reset(kJitter + axis, 0.0, jitter_variance);
}

Status RelativeFilter::linearise(const DifferentialEpoch& epoch, const ReceiverPlatform& servicer,
                                 const ReceiverPlatform& target) {
  using Transform = estimation::UnscentedTransform<kHead>;
  using Scalar = Eigen::Matrix<double, 1, 1>;
  Transform transform;
  if (const Status status = transform.start(estimate_.mean().head<kHead>(), estimate_.head_covariance<kHead>());
      status != Status::kOk) {
    return status;
  }
  reference_ = estimate_.mean().head<kGeometry>();
  const Vector3 servicer_antenna =
      antenna_position(servicer, servicer.state) + servicer.R_eci_body * reference_.segment<3>(kServicerAntenna);
  std::array<Vector3, Transform::kPoints> target_antennas;
  for (std::size_t k = 0; k < Transform::kPoints; ++k) {
    const Transform::Vector x = transform.point(k);
    const orbit::CartesianState state{.position_eci = servicer.state.position_eci + x.segment<3>(kPosition),
                                      .velocity_eci = servicer.state.velocity_eci + x.segment<3>(kVelocity)};
    target_antennas[k] = antenna_position(target, state) + target.R_eci_body * reference_.segment<3>(kTargetAntenna);
  }
  for (std::size_t n = 0; n < epoch.count; ++n) {
    const DifferentialObservation& observation = epoch.observations[n];
    const Vector3 servicer_line = servicer_antenna - observation.servicer_source_eci;
    const double servicer_range = servicer_line.norm();
    std::array<Scalar, Transform::kPoints> ranges;
    for (std::size_t k = 0; k < ranges.size(); ++k) {
      ranges[k](0) = (target_antennas[k] - observation.target_source_eci).norm() - servicer_range;
    }
    const auto regression = transform.regress<1>(ranges);
    const Vector3 target_direction = (target_antennas[0] - observation.target_source_eci).normalized();
    Row& row = rows_[n];
    row = Row{};
    row.predicted = regression.mean(0) + reference_(kClock);
    row.extra_variance = regression.nonlinearity(0);
    row.jacobian.head<kHead>() = regression.jacobian.transpose();
    row.jacobian.segment<3>(kServicerAntenna) = -servicer.R_eci_body.transpose() * (servicer_line / servicer_range);
    row.jacobian.segment<3>(kTargetAntenna) = target.R_eci_body.transpose() * target_direction;
    row.jacobian.segment<3>(kJitter) = target_direction;
    row.jacobian(kClock) = 1.0;
  }
  return Status::kOk;
}

/// Measured minus predicted by the current state; code bias and ambiguity excluded.
double RelativeFilter::residual(const Row& row, double measured) const {
  return measured - row.predicted - row.jacobian.dot(estimate_.mean().head<kGeometry>() - reference_);
}

/// Measured minus predicted phase of a channel, all states included.
double RelativeFilter::phase_residual(const Row& row, std::size_t place, double measured) const {
  const double offset = estimate_.mean(ambiguity_index(place)) + estimate_.mean(wander_index(place));
  return residual(row, measured) - offset;
}

RelativeFilter::Estimate::Vector RelativeFilter::phase_jacobian(const Row& row, std::size_t place) const {
  Estimate::Vector jacobian = full_jacobian(row);
  jacobian(ambiguity_index(place)) = 1.0;
  jacobian(wander_index(place)) = 1.0;
  return jacobian;
}

RelativeFilter::Estimate::Vector RelativeFilter::full_jacobian(const Row& row) {
  Estimate::Vector jacobian = Estimate::Vector::Zero();
  jacobian.head<kGeometry>() = row.jacobian;
  return jacobian;
}

double RelativeFilter::code_residual(const Row& row, const DifferentialObservation& observation) const {
  const int bias = code_bias_index(observation.signal);
  return residual(row, observation.code_m) - (bias >= 0 ? estimate_.mean(bias) : 0.0);
}

RelativeFilter::Estimate::Vector RelativeFilter::code_jacobian(const Row& row, gnss::Signal signal) const {
  Estimate::Vector jacobian = full_jacobian(row);
  if (const int bias = code_bias_index(signal); bias >= 0) jacobian(bias) = 1.0;
  return jacobian;
}

/// The clock is unknown until the first code, which determines it whatever the error of that code (multipath of a
/// satellite that has just risen). Codes that contradict the median are therefore processed last: the gate then refuses
/// them, and not the others and all phases.
void RelativeFilter::find_outlying_codes(const DifferentialEpoch& epoch) {
  Residuals residuals;
  for (std::size_t n = 0; n < epoch.count; ++n) residuals.add({n, code_residual(rows_[n], epoch.observations[n])});
  if (residuals.count < kMinForMedian) return;
  const std::size_t middle = residuals.median().observation;
  const DifferentialObservation& median = epoch.observations[middle];
  for (std::size_t n = 0; n < epoch.count; ++n) {
    if (n == middle) continue;
    const DifferentialObservation& observation = epoch.observations[n];
    const Estimate::Vector jacobian =
        code_jacobian(rows_[n], observation.signal) - code_jacobian(rows_[middle], median.signal);
    const double apart_m = code_residual(rows_[n], observation) - residuals.median().value;
    // The variance of a median is about that of a mean.
    const double variance = observation.code_sigma_m * observation.code_sigma_m +
                            median.code_sigma_m * median.code_sigma_m / static_cast<double>(residuals.count);
    rows_[n].has_outlying_code = !(estimate_.predict(jacobian, apart_m, variance).nis() < kGate);
  }
}

void RelativeFilter::use_codes(const DifferentialEpoch& epoch, RelativeUpdate& update) {
  for (const bool outlying : {false, true}) {
    for (std::size_t n = 0; n < epoch.count; ++n) {
      if (rows_[n].has_outlying_code != outlying) continue;
      const DifferentialObservation& observation = epoch.observations[n];
      const double variance = observation.code_sigma_m * observation.code_sigma_m + rows_[n].extra_variance;
      const estimation::Innovation innovation = estimate_.update(code_jacobian(rows_[n], observation.signal),
                                                                 code_residual(rows_[n], observation), variance, kGate);
      if (innovation.accepted) {
        ++update.codes_used;
        update.code_nis += innovation.nis();
      } else {
        ++update.codes_refused;
      }
    }
  }
}

/// Assigns a channel to each usable phase, and finds the slips reported by the receivers.
void RelativeFilter::follow_channels(const DifferentialEpoch& epoch, RelativeUpdate& update) {
  for (std::size_t n = 0; n < epoch.count; ++n) {
    const DifferentialObservation& observation = epoch.observations[n];
    if (!observation.phase_usable) continue;
    std::optional<std::size_t> place = channels_.find(observation.satellite, observation.signal);
    if (!place) place = channels_.take(observation.satellite, observation.signal);
    if (!place) continue;
    if (channels_.lost_lock(*place, observation, epoch.time)) {
      ++update.slips;
      lose(*place);
    }
    rows_[n].channel = place;
  }
}

/// The clock shifts all phases alike, and the code determines it to decimetres only. Each phase is therefore compared
/// with the median: clock and common offset cancel.
void RelativeFilter::find_slips_by_median(const DifferentialEpoch& epoch, RelativeUpdate& update) {
  Residuals residuals;
  for (std::size_t n = 0; n < epoch.count; ++n) {
    const std::optional<std::size_t>& place = rows_[n].channel;
    if (!place || channels_[*place].epochs == 0) continue;
    residuals.add({n, phase_residual(rows_[n], *place, epoch.observations[n].phase_m)});
  }
  if (residuals.count < kMinForMedian) return;
  const std::size_t middle = residuals.median().observation;
  for (std::size_t k = 0; k < residuals.count; ++k) {
    const std::size_t n = residuals.sorted[k].observation;
    if (n == middle) continue;
    const std::size_t place = *rows_[n].channel;
    const Estimate::Vector jacobian =
        phase_jacobian(rows_[n], place) - phase_jacobian(rows_[middle], *rows_[middle].channel);
    const double sigma_m = math::hypot(epoch.observations[n].phase_sigma_m, epoch.observations[middle].phase_sigma_m);
    const estimation::Innovation apart =
        estimate_.predict(jacobian, residuals.sorted[k].value - residuals.median().value, sigma_m * sigma_m);
    if (math::abs(apart.value) > kSlip_m + kSlipSigmas * math::sqrt(apart.variance)) {
      ++update.slips;
      contradict(place, update);
    }
  }
}

void RelativeFilter::use_phases(const DifferentialEpoch& epoch, RelativeUpdate& update) {
  // Known ambiguities first: they determine the clock with which new ones are initialised.
  for (const bool known : {true, false}) {
    for (std::size_t n = 0; n < epoch.count; ++n) {
      const std::optional<std::size_t>& place = rows_[n].channel;
      if (!place || (channels_[*place].epochs > 0) != known) continue;
      const DifferentialObservation& observation = epoch.observations[n];
      if (!known) begin_channel(*place, residual(rows_[n], observation.phase_m));
      const Estimate::Vector jacobian = phase_jacobian(rows_[n], *place);
      const double variance = observation.phase_sigma_m * observation.phase_sigma_m + rows_[n].extra_variance;
      const double value = phase_residual(rows_[n], *place, observation.phase_m);
      const estimation::Innovation innovation = estimate_.update(jacobian, value, variance, known ? kGate : kNoGate);
      if (!innovation.accepted) {
        ++update.phases_refused;
        contradict(*place, update);
        continue;
      }
      channels_.see(*place, observation, epoch.time);
      if (known) {
        ++update.phases_used;
        update.phase_nis += innovation.nis();
      }
      rows_[n].channel.reset();  // processed, so that the second round does not treat it as a new one
    }
  }
}

/// The wander starts with its stationary variance: a restarted channel may have assigned a slip to it.
void RelativeFilter::begin_channel(std::size_t place, double value_m) {
  estimate_.reset(ambiguity_index(place), value_m, kAmbiguitySigma_m * kAmbiguitySigma_m);
  estimate_.reset(wander_index(place), 0.0, 2.0 * settings_.phase_wander_sigma_m * settings_.phase_wander_sigma_m);
}

void RelativeFilter::deactivate(std::size_t place) {
  estimate_.reset(ambiguity_index(place), 0.0, 0.0);
  estimate_.reset(wander_index(place), 0.0, 0.0);
}

void RelativeFilter::lose(std::size_t place) {
  channels_.restart(place);
  deactivate(place);
}

void RelativeFilter::contradict(std::size_t place, RelativeUpdate& update) {
  if (channels_[place].fixed) ++update.contradictions;
  lose(place);
}

void RelativeFilter::hold(std::size_t place, std::size_t reference, double cycles) {
  // A tenth of a millimetre: far below the phase noise, far above rounding.
  constexpr double kHoldVariance = 1e-8;
  const double wavelength = gnss::wavelength(channels_[place].signal);
  Estimate::Vector jacobian = Estimate::Vector::Zero();
  jacobian(ambiguity_index(place)) = 1.0;
  jacobian(ambiguity_index(reference)) = -1.0;
  const double difference = estimate_.mean(ambiguity_index(place)) - estimate_.mean(ambiguity_index(reference));
  estimate_.update(jacobian, wavelength * cycles - difference, kHoldVariance, kNoGate);
  channels_.set_fixed(place, true);
  channels_.set_fixed(reference, true);
}

void RelativeFilter::release(double position_sigma_m) {
  for (std::size_t place = 0; place < kPhaseChannels; ++place) {
    if (channels_[place].in_use) lose(place);
  }
  // The time scale of the orbit converts the displacement into a velocity: 1/n is about 1000 s.
  const double velocity_sigma = 1e-3 * position_sigma_m;
  for (int axis = 0; axis < 3; ++axis) {
    estimate_.add_noise(kPosition + axis, position_sigma_m * position_sigma_m);
    estimate_.add_noise(kVelocity + axis, velocity_sigma * velocity_sigma);
  }
}

}  // namespace vbar::fsw::navigation
