#pragma once
// A recorded receiver, or the twin on the same orbit, through the own-orbit navigation of the flight software.

#include <functional>

#include "host_sim/flown_gnss/given_orbit.h"
#include "host_sim/flown_gnss/orbit_errors.h"
#include "host_sim/flown_gnss/own_orbit.h"
#include "host_sim/flown_gnss/signal_statistics.h"

namespace vbar::flown_gnss {

struct FlownSettings {
  fsw::filter::AbsoluteOrbitSettings filter;
  fsw::gnss::RangeErrors range_errors;
  double antenna_up_m = 0.0;  ///< from the centre of mass to the zenith
  double period_s = 10.0;     ///< between epochs
  double begin_s = 0.0;       ///< of the first epoch, after the first state of the orbit
  double duration_s = 86400.0;
};

struct FlownResult {
  explicit FlownResult(fsw::GpsTime first, double interval_s) : errors(first), signals(interval_s) {}
  OrbitErrors errors;
  SignalStatistics signals;
  ElevationBins ranges{};  ///< range as the single point uses it, less that to the satellite and the epoch's mean, m
  fsw::measurements::OwnGnssCounters counters;
  std::size_t epochs = 0;
  std::size_t satellites = 0;  ///< sum over the epochs
};

/// Flies from `begin_s` on. Throws what receiver and orbit throw.
[[nodiscard]] FlownResult fly(GivenOrbit& orbit, twins::gnss::ReceiverBytes& receiver, const FlownSettings& settings);

}  // namespace vbar::flown_gnss
