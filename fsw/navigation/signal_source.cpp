#include "fsw/navigation/signal_source.h"

#include "fsw/math/math.h"

namespace vbar::fsw::navigation {
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

}  // namespace vbar::fsw::navigation
