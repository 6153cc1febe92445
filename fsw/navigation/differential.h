#pragma once
// Single differences, target minus servicer, of two receivers' observations with the same tag. Clock and orbit
// errors of the satellite, and nearly all of the ionospheric delay, are common to both and cancel.

#include <array>
#include <cstddef>

#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"
#include "fsw/gnss/observation.h"
#include "fsw/navigation/signal_source.h"

namespace vbar::fsw::navigation {

struct DifferentialObservation {
  gnss::SatelliteId satellite;
  gnss::Signal signal = gnss::Signal::kGpsL1;
  double code_m = 0.0;  ///< pseudoranges, each corrected for the satellite clock at transmission
  double phase_m = 0.0;
  bool phase_usable = false;  ///< on both sides
  double code_sigma_m = 0.0;
  double phase_sigma_m = 0.0;
  double servicer_lock_s = 0.0;
  double target_lock_s = 0.0;
  // The two signals were transmitted at different instants, since receiver clocks and ranges differ.
  Vector3 servicer_source_eci = Vector3::Zero();
  Vector3 target_source_eci = Vector3::Zero();
};

struct DifferentialEpoch {
  GpsTime time;  ///< the tag of both
  std::size_t count = 0;
  std::array<DifferentialObservation, gnss::kMaxObservations> observations{};
};

/// Differences of all signals common to both epochs (of one tag) with a known ephemeris, into `out`.
void form_differences(const gnss::ObservationEpoch& servicer, const gnss::ObservationEpoch& target,
                      const EphemerisStore& ephemerides, const EarthFrame& frame, DifferentialEpoch& out);

}  // namespace vbar::fsw::navigation
