#pragma once
// Position and time of transmission of a received signal, from the pseudorange alone, without the receiver position.

#include "fsw/core/result.h"
#include "fsw/core/types.h"
#include "fsw/gnss/observation.h"
#include "fsw/navigation/ephemeris_store.h"
#include "fsw/orbit/earth_rotation.h"

namespace vbar::fsw::navigation {

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

}  // namespace vbar::fsw::navigation
