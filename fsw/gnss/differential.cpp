#include "fsw/gnss/differential.h"

#include <compare>

#include "fsw/math/math.h"

namespace vbar::fsw::gnss {

namespace {

constexpr double kShortestRange = 15e6;
constexpr double kLongestRange = 60e6;

}  // namespace

Vector3 EarthFrame::eci_from_itrf(const Vector3& itrf, double seconds_later) const {
  // R(time + s) = R3(rate s) R(time)
  const double angle = orbit::kEarthRotationRate * seconds_later;
  const double s = math::sin(angle);
  const double c = math::cos(angle);
  const Vector3 rotated(c * itrf.x() - s * itrf.y(), s * itrf.x() + c * itrf.y(), itrf.z());
  return R_itrf_gcrf.transpose() * rotated;
}

Result<SignalSource> signal_source(gnss::SatelliteId satellite, double pseudorange_m, GpsTime receiver_time,
                                   const EphemerisStore& ephemerides, const EarthFrame& frame) {
  // Written such that a NaN is rejected.
  if (!(pseudorange_m >= kShortestRange && pseudorange_m <= kLongestRange)) return Status::kOutOfRange;
  const gnss::Ephemeris* ephemeris = ephemerides.find(satellite, receiver_time);
  if (ephemeris == nullptr) return Status::kNotReady;
  // By the satellite's clock the signal was transmitted at receiver_time - P/c, whatever the receiver's clock error.
  const GpsTime by_satellite_clock = receiver_time - nearest_duration(pseudorange_m / gnss::kSpeedOfLight);
  const Result<gnss::SatelliteState> first = gnss::satellite_state(*ephemeris, by_satellite_clock);
  if (!first.ok()) return first.status();
  const GpsTime sent = by_satellite_clock - nearest_duration(first.value().clock_s);
  const Result<gnss::SatelliteState> state = gnss::satellite_state(*ephemeris, sent);
  if (!state.ok()) return state.status();
  return SignalSource{.position_eci = frame.eci_from_itrf(state.value().position_ecef, seconds(sent - frame.time)),
                      .clock_m = gnss::kSpeedOfLight * state.value().clock_s};
}

namespace {

// The sigmas reported by receivers are optimistic; lower bounds apply.
constexpr double kMinCodeSigma_m = 0.05;
constexpr double kMinPhaseSigma_m = 0.3e-3;

std::strong_ordering order(const gnss::Observation& a, const gnss::Observation& b) {
  if (const auto by_satellite = a.satellite <=> b.satellite; by_satellite != 0) return by_satellite;
  if (const auto by_signal = a.signal <=> b.signal; by_signal != 0) return by_signal;
  return a.code <=> b.code;
}

double difference_sigma(double a, double b, double minimum) {
  const double floor_a = a > minimum ? a : minimum;
  const double floor_b = b > minimum ? b : minimum;
  return math::hypot(floor_a, floor_b);
}

}  // namespace

void form_differences(const gnss::ObservationEpoch& servicer, const gnss::ObservationEpoch& target,
                      const EphemerisStore& ephemerides, const EarthFrame& frame, DifferentialEpoch& out) {
  out.time = servicer.receiver_time;
  out.count = 0;
  std::size_t t = 0;
  for (std::size_t s = 0; s < servicer.count; ++s) {
    const gnss::Observation& ours = servicer.observations[s];
    while (t < target.count && order(target.observations[t], ours) < 0) ++t;
    if (t == target.count) return;
    const gnss::Observation& theirs = target.observations[t];
    if (order(theirs, ours) != 0) continue;
    // One ephemeris for both: receivers may hold different ones, whose errors would not cancel.
    const auto our_source =
        signal_source(ours.satellite, ours.pseudorange_m, servicer.receiver_time, ephemerides, frame);
    const auto their_source =
        signal_source(theirs.satellite, theirs.pseudorange_m, target.receiver_time, ephemerides, frame);
    if (!our_source.ok() || !their_source.ok()) continue;
    const double wavelength = gnss::wavelength(ours.signal);
    const double clock_difference = their_source.value().clock_m - our_source.value().clock_m;
    DifferentialObservation& difference = out.observations[out.count];
    difference = {
        .satellite = ours.satellite,
        .signal = ours.signal,
        .code_m = theirs.pseudorange_m - ours.pseudorange_m + clock_difference,
        .phase_m = wavelength * (theirs.carrier_phase_cycles - ours.carrier_phase_cycles) + clock_difference,
        .phase_usable = ours.phase_usable && theirs.phase_usable,
        .code_sigma_m = difference_sigma(ours.pseudorange_sigma_m, theirs.pseudorange_sigma_m, kMinCodeSigma_m),
        .phase_sigma_m = difference_sigma(wavelength * ours.phase_sigma_cycles, wavelength * theirs.phase_sigma_cycles,
                                          kMinPhaseSigma_m),
        .servicer_lock_s = ours.lock_time_s,
        .target_lock_s = theirs.lock_time_s,
        .servicer_source_eci = our_source.value().position_eci,
        .target_source_eci = their_source.value().position_eci};
    const double check = difference.code_m + difference.phase_m + difference.code_sigma_m + difference.phase_sigma_m;
    if (math::is_finite(check)) ++out.count;
  }
}

}  // namespace vbar::fsw::gnss
