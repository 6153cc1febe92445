#pragma once
// What two receivers saw of the same satellites at the same tag: single differences, target minus servicer. The
// satellite's clock and orbit, and nearly all of the ionosphere, are the same for both and fall out.

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
  double code_m = 0.0;  ///< pseudoranges, each corrected for the satellite's clock when it sent
  double phase_m = 0.0;
  bool phase_usable = false;  ///< on both sides
  double code_sigma_m = 0.0;
  double phase_sigma_m = 0.0;
  double servicer_lock_s = 0.0;
  double target_lock_s = 0.0;
  // The two signals left at different instants: receivers' clocks differ, and so do ranges.
  Vector3 servicer_source_eci = Vector3::Zero();
  Vector3 target_source_eci = Vector3::Zero();
};

struct DifferentialEpoch {
  GpsTime time;  ///< the tag of both
  std::size_t count = 0;
  std::array<DifferentialObservation, gnss::kMaxObservations> observations{};
};

/// Differences of all signals that both epochs (of one tag) hold and the ephemerides know, into `out`.
void form_differences(const gnss::ObservationEpoch& servicer, const gnss::ObservationEpoch& target,
                      const EphemerisStore& ephemerides, const EarthFrame& frame, DifferentialEpoch& out);

}  // namespace vbar::fsw::navigation
