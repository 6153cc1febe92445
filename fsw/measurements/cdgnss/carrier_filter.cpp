#include "fsw/measurements/cdgnss/carrier_filter.h"

#include <algorithm>

#include "fsw/math/math.h"
#include "fsw/orbit/roe.h"

namespace vbar::fsw::measurements {
namespace {

using filter::kAt;
using gnss::DifferentialEpoch;
using gnss::DifferentialObservation;

constexpr double kGate = 25.0;  // 5 sigma, one degree of freedom
constexpr double kNoGate = estimation::kNoGate;

// The clock difference of single-point solutions is wrong by some metres; this sigma gives it negligible weight.
constexpr double kClockSigma_m = 100.0;
// Sigma of an ambiguity that is initialised from its own first measurement.
constexpr double kAmbiguitySigma_m = 30.0;

// A phase that differs by this from the others of the epoch, in addition to the uncertainty of the filter, has slipped.
constexpr double kSlip_m = 0.03;
constexpr double kSlipSigmas = 5.0;
constexpr std::size_t kMinForMedian = 5;

// Phases wait until the elements are so narrow that their curvature moves the target by less than this: codes attain it
// in a few epochs. Phases of a wider orbit would update it along a wrong tangent, with the weight of a millimetre.
constexpr double kMaxNonlinearity_m = 0.3e-3;

// The orbit is contradicted where a displacement of the target explains an epoch by this ratio of likelihoods: 6 sigma
// of three degrees of freedom, for codes 7, whose multipath is correlated. What it leaves has at most this mean square.
constexpr double kPhaseGate = 40.0;
constexpr double kCodeGate = 56.0;
constexpr double kMaxRest = 4.0;
// Receivers smooth codes by the carrier for some 100 s, and the delay of the ionosphere that changes meanwhile differs
// between two receivers of which one has begun later: with the pattern of a displacement.
constexpr double kSmoothed_s = 300.0;
constexpr double kSmoothedAlike_s = 30.0;
constexpr double kSmoothingError_m = 1.0;  // of such a displacement, at most
// Displacements below this are those of attitudes, antennas and wander.
constexpr double kMinDisplacement_m = 5e-3;
// An orbit is verified by this number of channels that were tracked for this number of epochs: their ambiguities are
// then those of another orbit than the present one.
constexpr int kProvenEpochs = 6;
constexpr int kMinProven = 5;
// The burn that would have displaced the target in the time since, times this: it may have been flown late.
constexpr double kBurnMargin = 2.0;
// A larger one, m/s, is none: the measurements or the whole orbit are then wrong, which the codes decide.
constexpr double kLargestBurn = 1.0;
constexpr Duration kLongestUnverified = duration_of_seconds(6000);

// Lengths of the baseline: below, differential delays are some hundredths of a millimetre.
constexpr double kIonosphereFrom_m = 40.0;
constexpr double kIonosphereUntil_m = 30.0;

// Steps of the Jacobian of the ROE.
constexpr double kStep_m = 1.0;
constexpr double kStep_mps = 1e-3;

constexpr double square(double x) {
  return x * x;
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

/// Returns whether the codes of both receivers have been smoothed for the same time, or for long.
bool are_smoothed_alike(const DifferentialObservation& observation) {
  const double servicer_s = std::min(observation.servicer_lock_s, kSmoothed_s);
  const double target_s = std::min(observation.target_lock_s, kSmoothed_s);
  return std::max(servicer_s, target_s) - std::min(servicer_s, target_s) <= kSmoothedAlike_s;
}

}  // namespace

void CarrierFilter::configure(const CarrierFilterSettings& settings) {
  if (settings.antenna_offset_sigma_m != settings_.antenna_offset_sigma_m) {
    antenna_sigma_m_ = settings.antenna_offset_sigma_m;
  }
  settings_ = settings;
}

void CarrierFilter::activate_blocks(filter::RelativeNavigationFilter& filter) const {
  filter::Estimate& estimate = filter.estimate();
  const estimation::GaussMarkov offset{.sigma = antenna_sigma_m_};
  if (!filter::is_active<ServicerAntenna>(estimate)) filter::initialize_block<ServicerAntenna>(estimate, offset);
  if (!filter::is_active<TargetAntenna>(estimate)) filter::initialize_block<TargetAntenna>(estimate, offset);
  if (!filter::is_active<CodeBiases>(estimate)) {
    filter::initialize_block<CodeBiases>(estimate, {.sigma = settings_.code_bias_sigma_m});
  }
  filter.relative_orbit().activate_empirical(estimate);
}

void CarrierFilter::deactivate_blocks(filter::RelativeNavigationFilter& filter) {
  deactivate_channels(filter);
  deactivate_epoch_states(filter);
  filter::Estimate& estimate = filter.estimate();
  filter::deactivate_block<Ionosphere>(estimate);
  filter::deactivate_block<CodeBiases>(estimate);
  filter::deactivate_block<TargetAntenna>(estimate);
  filter::deactivate_block<ServicerAntenna>(estimate);
  filter::deactivate_block<filter::EmpiricalAcceleration>(estimate);
  last_epoch_.reset();
  verified_.reset();
}

void CarrierFilter::deactivate_epoch_states(filter::RelativeNavigationFilter& filter) {
  filter::deactivate_block<ClockDifference>(filter.estimate());
  filter::deactivate_block<PhaseCentreJitter>(filter.estimate());
}

void CarrierFilter::deactivate_channels(filter::RelativeNavigationFilter& filter) {
  channels_.clear();
  filter::deactivate_block<PhaseWander>(filter.estimate());
  filter::deactivate_block<Ambiguities>(filter.estimate());
}

CarrierUpdate CarrierFilter::process_epoch(const DifferentialEpoch& epoch, const AntennaPlatform& servicer,
                                           const AntennaPlatform& target, filter::RelativeNavigationFilter& filter) {
  CarrierUpdate update;
  if (!filter.has_relative() || epoch.count == 0) return update;
  filter::Estimate& estimate = filter.estimate();
  channels_.give_back_unseen(last_epoch_.value_or(epoch.time),
                             [&estimate](std::size_t place) { deactivate(place, estimate); });
  renew_epoch_states(servicer, target, estimate);
  edits_.fill(Edit{});
  if (rows_.form(epoch, servicer, target, filter) != Status::kOk) return update;
  follow_ionosphere(filter);
  const bool uses_phases = rows_.nonlinearity_m() < kMaxNonlinearity_m || channels_.is_any_tracked();
  if (uses_phases) follow_channels(epoch, estimate, update);
  // Before the codes: against a wrong orbit they would determine a wrong clock.
  for (const Observable observable : {Observable::kPhase, Observable::kCode}) {
    if (!test_orbit(observable, epoch, filter, update)) continue;
    // The model of the observations about the same mean, with the new covariance.
    if (rows_.form(epoch, servicer, target, filter) != Status::kOk) return update;
  }
  find_outlying_codes(epoch, estimate);
  use_codes(epoch, estimate, update);
  if (uses_phases) {
    find_slips_by_median(epoch, estimate, update);
    use_phases(epoch, filter, update);
  }
  filter.finish_update();
  last_epoch_ = epoch.time;
  return update;
}

/// Innovations of the codes, or of the phases of known ambiguities, against a displacement of the target.
Displacement CarrierFilter::displacement_by(Observable observable, const DifferentialEpoch& epoch,
                                            const filter::Estimate& estimate) {
  test_.clear();
  std::array<std::size_t, DisplacementTest::kMaxRows> tested{};
  const auto sensitivity = [&](std::size_t n) {
    const gnss::Signal signal = epoch.observations[n].signal;
    return observable == Observable::kCode ? rows_.code_sensitivity(n, signal)
                                           : rows_.phase_sensitivity(n, *edits_[n].channel, signal);
  };
  for (std::size_t n = 0; n < epoch.count && !test_.is_full(); ++n) {
    const DifferentialObservation& observation = epoch.observations[n];
    const std::optional<std::size_t>& place = edits_[n].channel;
    if (observable == Observable::kPhase && (!place || channels_[*place].epochs == 0)) continue;
    const bool is_code = observable == Observable::kCode;
    const double innovation = is_code ? rows_.code_residual(n, observation, estimate)
                                      : rows_.phase_residual(n, *place, observation, estimate);
    const double sigma = is_code ? observation.code_sigma_m : observation.phase_sigma_m;
    const int row = test_.count();
    tested[static_cast<std::size_t>(row)] = n;
    test_.add(innovation, rows_.direction(n));
    const filter::Estimate::Vector ph = estimate.covariance_times(sensitivity(n));
    for (int other = 0; other < row; ++other) {
      test_.set_covariance(row, other, sensitivity(tested[static_cast<std::size_t>(other)]).dot(ph));
    }
    test_.set_covariance(row, row, sensitivity(n).dot(ph) + square(sigma) + rows_.extra_variance(n));
  }
  return test_.evaluate(observable == Observable::kCode ? kCodeGate : kPhaseGate, kMaxRest);
}

/// Number of signals of the epoch whose ambiguities have been known for long.
int CarrierFilter::proven_in(const DifferentialEpoch& epoch) const {
  int proven = 0;
  for (std::size_t n = 0; n < epoch.count; ++n) {
    const DifferentialObservation& observation = epoch.observations[n];
    const std::optional<std::size_t> place = channels_.find(observation.satellite, observation.signal);
    const bool is_proven = observation.phase_usable && place && channels_[*place].epochs >= kProvenEpochs;
    if (is_proven && !channels_.lost_lock(*place, observation, epoch.time)) ++proven;
  }
  return proven;
}

/// Decides, before an epoch updates the estimate, whether the estimate is wrong: then it is opened by what can have
/// made it so, which the same epoch corrects, and true is returned. Otherwise each measurement is judged by itself.
bool CarrierFilter::test_orbit(Observable observable, const DifferentialEpoch& epoch,
                               filter::RelativeNavigationFilter& filter, CarrierUpdate& update) {
  // Phases of known ambiguities are a thousand times as accurate.
  const bool has_proven = proven_in(epoch) >= kMinProven;
  if (observable == Observable::kCode && has_proven) return false;
  const Displacement displacement = displacement_by(observable, epoch, filter.estimate());
  if (!displacement.is_tested) return false;
  const double size_m = math::sqrt(displacement.metres.squaredNorm());
  const auto end = epoch.observations.begin() + epoch.count;
  const bool may_be_smoothing =
      observable == Observable::kCode && !std::all_of(epoch.observations.begin(), end, are_smoothed_alike);
  const double least_m = may_be_smoothing ? kSmoothingError_m : kMinDisplacement_m;
  if (!displacement.is_detected || size_m < least_m) {
    const bool agrees = observable == Observable::kPhase && displacement.ratio <= kPhaseGate;
    if (agrees && has_proven) verified_ = epoch.time;
    return false;
  }
  if (!open_orbit(displacement, observable, epoch.time, filter)) return false;
  update.displacement_ratio = displacement.ratio;
  return true;
}

/// The estimate was right when it was verified last: a burn since then has displaced the target. Ambiguities that were
/// determined since by the displaced orbit are wrong as well; those of before hold, and correct the orbit at once.
bool CarrierFilter::open_orbit(const Displacement& displacement, Observable observable, GpsTime now,
                               filter::RelativeNavigationFilter& filter) {
  GpsTime since = verified_ && now - *verified_ < kLongestUnverified ? *verified_ : now - kLongestUnverified;
  if (!verified_ && last_epoch_) since = *last_epoch_;
  // Time in which the displacement has grown: since the last epoch, or since the ambiguities that contradict it.
  GpsTime grown_since = last_epoch_.value_or(since);
  for (std::size_t place = 0; place < kPhaseChannels && observable == Observable::kPhase; ++place) {
    if (is_of_displaced_orbit(place, since) && channels_[place].first_seen < grown_since) {
      grown_since = channels_[place].first_seen;
    }
  }
  constexpr double kShortest_s = 1.0;
  const double elapsed_s = std::max(seconds(now - grown_since), kShortest_s);
  const double burn = math::sqrt(displacement.metres.squaredNorm()) / elapsed_s;
  if (burn > kLargestBurn) return false;
  for (std::size_t place = 0; place < kPhaseChannels; ++place) {
    if (is_of_displaced_orbit(place, since)) lose(place, filter.estimate());
  }
  filter.inflate_by_burn(since, kBurnMargin * burn);
  verified_ = now;
  return true;
}

/// The delays of two receivers differ by the curvature of the ionosphere over their baseline: by millimetres at low
/// elevations a kilometre apart, as if the baseline were shorter.
void CarrierFilter::follow_ionosphere(filter::RelativeNavigationFilter& filter) const {
  const bool is_active = filter::is_active<Ionosphere>(filter.estimate());
  if (!is_active && rows_.baseline_m() > kIonosphereFrom_m) {
    filter::initialize_block<Ionosphere>(filter.estimate(), filter.settings().processes.of<Ionosphere>());
  } else if (is_active && rows_.baseline_m() < kIonosphereUntil_m) {
    filter::deactivate_block<Ionosphere>(filter.estimate());
  }
}

/// Clocks and jitter are independent of the previous epoch.
void CarrierFilter::renew_epoch_states(const AntennaPlatform& servicer, const AntennaPlatform& target,
                                       filter::Estimate& estimate) {
  estimate.reset(kAt<ClockDifference>, target.clock_m - servicer.clock_m, square(kClockSigma_m));
  const double jitter_variance = 2.0 * square(settings_.phase_centre_jitter_m);
  for (int axis = 0; axis < 3; ++axis) estimate.reset(kAt<PhaseCentreJitter> + axis, 0.0, jitter_variance);
}

/// The clock is unknown until the first code, which determines it whatever the error of that code (multipath of a
/// satellite that has just risen). Codes that contradict the median are therefore processed last: the gate then rejects
/// them, and not the others and all phases.
void CarrierFilter::find_outlying_codes(const DifferentialEpoch& epoch, const filter::Estimate& estimate) {
  Residuals residuals;
  for (std::size_t n = 0; n < epoch.count; ++n) {
    residuals.add({n, rows_.code_residual(n, epoch.observations[n], estimate)});
  }
  if (residuals.count < kMinForMedian) return;
  const std::size_t middle = residuals.median().observation;
  const DifferentialObservation& median = epoch.observations[middle];
  for (std::size_t n = 0; n < epoch.count; ++n) {
    if (n == middle) continue;
    const DifferentialObservation& observation = epoch.observations[n];
    const filter::Estimate::Vector h =
        rows_.code_sensitivity(n, observation.signal) - rows_.code_sensitivity(middle, median.signal);
    const double apart_m = rows_.code_residual(n, observation, estimate) - residuals.median().value;
    // The variance of a median is about that of a mean.
    const double variance =
        square(observation.code_sigma_m) + square(median.code_sigma_m) / static_cast<double>(residuals.count);
    edits_[n].has_outlying_code = !(estimate.predict(h, apart_m, variance).nis() < kGate);
  }
}

void CarrierFilter::use_codes(const DifferentialEpoch& epoch, filter::Estimate& estimate, CarrierUpdate& update) {
  for (const bool outlying : {false, true}) {
    for (std::size_t n = 0; n < epoch.count; ++n) {
      if (edits_[n].has_outlying_code != outlying) continue;
      const DifferentialObservation& observation = epoch.observations[n];
      const double variance = square(observation.code_sigma_m) + rows_.extra_variance(n);
      const estimation::Innovation innovation =
          estimate.update(rows_.code_sensitivity(n, observation.signal), rows_.code_residual(n, observation, estimate),
                          variance, kGate);
      if (innovation.accepted) {
        ++update.codes_used;
        update.code_nis += innovation.nis();
      } else {
        ++update.codes_rejected;
      }
    }
  }
}

/// Assigns a channel to each usable phase, and finds the slips reported by the receivers.
void CarrierFilter::follow_channels(const DifferentialEpoch& epoch, filter::Estimate& estimate, CarrierUpdate& update) {
  for (std::size_t n = 0; n < epoch.count; ++n) {
    const DifferentialObservation& observation = epoch.observations[n];
    if (!observation.phase_usable) continue;
    std::optional<std::size_t> place = channels_.find(observation.satellite, observation.signal);
    if (!place) place = channels_.take(observation.satellite, observation.signal);
    if (!place) continue;
    if (channels_.lost_lock(*place, observation, epoch.time)) {
      ++update.slips;
      lose(*place, estimate);
    }
    edits_[n].channel = place;
  }
}

/// The clock shifts all phases alike, and the code determines it to decimetres only. Each phase is therefore compared
/// with the median: clock and common offset cancel.
void CarrierFilter::find_slips_by_median(const DifferentialEpoch& epoch, filter::Estimate& estimate,
                                         CarrierUpdate& update) {
  Residuals residuals;
  for (std::size_t n = 0; n < epoch.count; ++n) {
    const std::optional<std::size_t>& place = edits_[n].channel;
    if (!place || channels_[*place].epochs == 0) continue;
    residuals.add({n, rows_.phase_residual(n, *place, epoch.observations[n], estimate)});
  }
  if (residuals.count < kMinForMedian) return;
  const std::size_t middle = residuals.median().observation;
  for (std::size_t k = 0; k < residuals.count; ++k) {
    const std::size_t n = residuals.sorted[k].observation;
    if (n == middle) continue;
    const std::size_t place = *edits_[n].channel;
    const filter::Estimate::Vector h =
        rows_.phase_sensitivity(n, place, epoch.observations[n].signal) -
        rows_.phase_sensitivity(middle, *edits_[middle].channel, epoch.observations[middle].signal);
    const double variance =
        square(epoch.observations[n].phase_sigma_m) + square(epoch.observations[middle].phase_sigma_m);
    const estimation::Innovation apart =
        estimate.predict(h, residuals.sorted[k].value - residuals.median().value, variance);
    if (math::abs(apart.value) > kSlip_m + kSlipSigmas * math::sqrt(apart.variance)) {
      ++update.slips;
      contradict(place, estimate, update);
    }
  }
}

void CarrierFilter::use_phases(const DifferentialEpoch& epoch, filter::RelativeNavigationFilter& filter,
                               CarrierUpdate& update) {
  filter::Estimate& estimate = filter.estimate();
  // Known ambiguities first: they determine the clock with which new ones are initialised.
  for (const bool known : {true, false}) {
    for (std::size_t n = 0; n < epoch.count; ++n) {
      const std::optional<std::size_t>& place = edits_[n].channel;
      if (!place || (channels_[*place].epochs > 0) != known) continue;
      const DifferentialObservation& observation = epoch.observations[n];
      if (!known) {
        // The wander starts with its stationary variance: a restarted channel may have assigned a slip to it.
        estimate.reset(ambiguity_index(*place), rows_.residual(n, observation.phase_m, estimate),
                       square(kAmbiguitySigma_m));
        estimation::initialize_process(estimate, wander_index(*place), filter.settings().processes.of<PhaseWander>());
      }
      const double variance = square(observation.phase_sigma_m) + rows_.extra_variance(n);
      const estimation::Innovation innovation =
          estimate.update(rows_.phase_sensitivity(n, *place, observation.signal),
                          rows_.phase_residual(n, *place, observation, estimate), variance, known ? kGate : kNoGate);
      if (!innovation.accepted) {
        ++update.phases_rejected;
        contradict(*place, estimate, update);
        continue;
      }
      channels_.see(*place, observation, epoch.time);
      if (known) {
        ++update.phases_used;
        update.phase_nis += innovation.nis();
      }
      edits_[n].channel.reset();  // processed, so that the second round does not treat it as a new one
    }
  }
}

void CarrierFilter::deactivate(std::size_t place, filter::Estimate& estimate) {
  estimate.reset(ambiguity_index(place), 0.0, 0.0);
  estimate.reset(wander_index(place), 0.0, 0.0);
}

void CarrierFilter::lose(std::size_t place, filter::Estimate& estimate) {
  channels_.restart(place);
  deactivate(place, estimate);
}

void CarrierFilter::contradict(std::size_t place, filter::Estimate& estimate, CarrierUpdate& update) {
  if (channels_[place].fixed) ++update.contradictions;
  lose(place, estimate);
}

void CarrierFilter::hold(filter::RelativeNavigationFilter& filter, std::size_t place, std::size_t reference,
                         double cycles) {
  // A tenth of a millimetre: far below the phase noise, far above rounding.
  constexpr double kHoldVariance = 1e-8;
  filter::Estimate& estimate = filter.estimate();
  filter::Estimate::Vector h = filter::Estimate::Vector::Zero();
  h(ambiguity_index(place)) = 1.0;
  h(ambiguity_index(reference)) = -1.0;
  const double difference = estimate.mean(ambiguity_index(place)) - estimate.mean(ambiguity_index(reference));
  const double wavelength = gnss::wavelength(channels_[place].signal);
  estimate.update(h, wavelength * cycles - difference, kHoldVariance, kNoGate);
  channels_.set_fixed(place, true);
  channels_.set_fixed(reference, true);
  filter.finish_update();
}

void CarrierFilter::release(filter::RelativeNavigationFilter& filter, double position_sigma_m) {
  filter::Estimate& estimate = filter.estimate();
  for (std::size_t place = 0; place < kPhaseChannels; ++place) {
    if (channels_[place].in_use) lose(place, estimate);
  }
  const auto target = filter.target();
  if (!target.ok()) return;
  const auto jacobian = roe_from_target_jacobian(filter.servicer(), target.value());
  if (!jacobian.ok()) return;
  // The time scale of the orbit converts the displacement into a velocity: 1/n is about 1000 s.
  const double velocity_sigma = 1e-3 * position_sigma_m;
  Matrix6 scaled = jacobian.value();
  scaled.leftCols<3>() *= position_sigma_m;
  scaled.rightCols<3>() *= velocity_sigma;
  estimate.transform_head<6>(filter.roe(), Matrix6::Identity(), scaled.lazyProduct(scaled.transpose()));
  filter.finish_update();
}

double CarrierFilter::antenna_misfit(const filter::Estimate& estimate) const {
  double sum_m2 = 0.0;
  for (const int block : {kAt<ServicerAntenna>, kAt<TargetAntenna>}) {
    for (int axis = 0; axis < 3; ++axis) sum_m2 += square(estimate.mean(block + axis));
  }
  return math::sqrt(sum_m2) / antenna_sigma_m_;
}

void CarrierFilter::widen_antennas(filter::RelativeNavigationFilter& filter, double factor) {
  const double added = (square(factor) - 1.0) * square(antenna_sigma_m_);
  antenna_sigma_m_ *= factor;
  for (const int block : {kAt<ServicerAntenna>, kAt<TargetAntenna>}) {
    for (int axis = 0; axis < 3; ++axis) filter.estimate().add_noise(block + axis, added);
  }
  filter.finish_update();
}

Result<Matrix6> roe_from_target_jacobian(const orbit::CartesianState& servicer, const orbit::CartesianState& target) {
  Matrix6 jacobian;
  for (int k = 0; k < 6; ++k) {
    orbit::CartesianState plus = target;
    orbit::CartesianState minus = target;
    const double step = k < 3 ? kStep_m : kStep_mps;
    if (k < 3) {
      plus.position_eci(k) += step;
      minus.position_eci(k) -= step;
    } else {
      plus.velocity_eci(k - 3) += step;
      minus.velocity_eci(k - 3) -= step;
    }
    const auto a = orbit::roe_of_target(servicer, plus);
    const auto b = orbit::roe_of_target(servicer, minus);
    if (!a.ok()) return a.status();
    if (!b.ok()) return b.status();
    jacobian.col(k) = (a.value() - b.value()) / (2.0 * step);
  }
  return jacobian;
}

}  // namespace vbar::fsw::measurements
