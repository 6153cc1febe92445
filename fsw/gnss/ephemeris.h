#pragma once
// Broadcast ephemerides of GPS, Galileo and BeiDou in one form, and the satellite state computed from them: Keplerian
// elements with secular rates and harmonic corrections, clock polynomial with relativity.
// IS-GPS-200N 20.3.3.4.3 (orbit) and 20.3.3.3.3.1 (clock); Galileo OS SIS ICD 2.1, 5.1.1 and 5.1.4;
// BDS-SIS-ICD-B1I-3.0, 5.2.4.9 to 5.2.4.12 (inclined and medium orbits; the geostationary satellites' rotated frame
// included).

#include <array>
#include <cstddef>

#include "fsw/core/gps_time.h"
#include "fsw/core/result.h"
#include "fsw/core/types.h"
#include "fsw/gnss/observation.h"

namespace vbar::fsw::gnss {

struct Ephemeris {
  SatelliteId satellite;
  std::int32_t issue = 0;  ///< IODE, IODnav, AODE: identifies the set
  bool healthy = false;
  GpsTime toe;          ///< reference time of the orbit, in GPS time for every system
  GpsTime toc;          ///< reference time of the clock, in GPS time for every system
  double sqrt_a = 0.0;  ///< m^(1/2)
  double e = 0.0;
  double m0 = 0.0;         ///< rad, as all angles
  double delta_n = 0.0;    ///< rad/s
  double omega0 = 0.0;     ///< longitude of the node at the week's beginning (of the system's own week)
  double omega_dot = 0.0;  ///< rad/s
  double i0 = 0.0;
  double i_dot = 0.0;  ///< rad/s
  double omega = 0.0;  ///< argument of perigee
  double cuc = 0.0, cus = 0.0, cic = 0.0, cis = 0.0;
  double crc = 0.0, crs = 0.0;             ///< m
  double toe_of_week_s = 0.0;              ///< toe as broadcast, in the system's own week
  double af0 = 0.0, af1 = 0.0, af2 = 0.0;  ///< clock: s, s/s, s/s^2
  double group_delay_s = 0.0;              ///< TGD, BGD or TGD1 of the first signal
};

struct SatelliteState {
  Vector3 position_ecef = Vector3::Zero();  ///< at the time of transmission, in the frame of that instant
  Vector3 velocity_ecef = Vector3::Zero();
  double clock_s = 0.0;      ///< satellite clock ahead of its system's time, relativity included, group delay not
  double clock_drift = 0.0;  ///< s/s
};

/// Returns kOk if the elements are valid for a navigation satellite: finite, inside the ranges that the interface
/// documents allow.
Status check(const Ephemeris& ephemeris);

/// Returns the state at `time` (GPS time of transmission). kOutOfRange if `time` is more than four hours from toe or
/// the elements fail check().
Result<SatelliteState> satellite_state(const Ephemeris& ephemeris, GpsTime time);

// The broadcast ephemerides delivered by the receivers: the two latest sets of each satellite, so that a new set
// does not replace the one that applies to an epoch still being processed.

class EphemerisStore {
 public:
  /// Files a set. The status of gnss::check() if it is not a valid set; kOutOfRange for a satellite
  /// number outside the constellation. The same set again has no effect.
  Status put(const gnss::Ephemeris& ephemeris);

  /// The healthy set whose reference time is nearest to `time`, at most kLongestAge from it; nullptr if there is none.
  [[nodiscard]] const gnss::Ephemeris* find(gnss::SatelliteId satellite, GpsTime time) const;

  /// GPS sets are valid for two hours about their reference time, Galileo's and BeiDou's for one or more; an hour of
  /// margin, since an older set has errors of metres, which cancel in differences between two receivers.
  static constexpr Duration kLongestAge = duration_of_seconds(std::int64_t{3} * 3600);
  static constexpr std::size_t kSatellites = 32 + 36 + 63;

 private:
  struct Sets {
    std::array<gnss::Ephemeris, 2> set{};
    std::size_t count = 0;
  };
  std::array<Sets, kSatellites> satellites_{};
};

}  // namespace vbar::fsw::gnss
