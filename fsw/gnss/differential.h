#pragma once
// Single differences, target minus servicer, of two receivers' observations with the same tag. Clock and orbit
// errors of the satellite, and nearly all of the ionospheric delay, are common to both and cancel.

#include <array>
#include <cstddef>

#include "fsw/core/gps_time.h"
#include "fsw/core/result.h"
#include "fsw/core/types.h"
#include "fsw/gnss/ephemeris.h"
#include "fsw/gnss/observation.h"
#include "fsw/orbit/earth_rotation.h"

namespace vbar::fsw::gnss {

// Position and time of transmission of a received signal, from the pseudorange alone, without the receiver position.

/// The Earth-fixed frame about one instant: exact there, rotated by the mean rate within a second of it.
struct EarthFrame {
  GpsTime time;
  Matrix3 R_itrf_gcrf = Matrix3::Identity();

  static EarthFrame at(GpsTime time, const orbit::EarthOrientation& orientation) {
    return {.time = time, .R_itrf_gcrf = orbit::R_itrf_gcrf(time, orientation)};
  }
  /// To ECI from the Earth-fixed frame of an instant `seconds_later` than `time`.
  [[nodiscard]] Vector3 eci_from_itrf(const Vector3& itrf, double seconds_later) const;
};

struct SignalSource {
  Vector3 position_eci = Vector3::Zero();  ///< of the satellite at transmission
  double clock_m = 0.0;  ///< c times the satellite clock's advance: to be added to the pseudorange and to the phase
};

/// Returns the source of the signal with `pseudorange_m` received when the receiver's clock showed `receiver_time`.
/// kNotReady without an ephemeris of that satellite; kOutOfRange for a pseudorange outside that of navigation
/// satellites (15,000 km to 60,000 km, clock error of the receiver included).
Result<SignalSource> signal_source(gnss::SatelliteId satellite, double pseudorange_m, GpsTime receiver_time,
                                   const EphemerisStore& ephemerides, const EarthFrame& frame);

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

}  // namespace vbar::fsw::gnss
