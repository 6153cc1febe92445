#pragma once
// Broadcast elements fitted to precise orbits and clocks (SP3): what a receiver's decoder can read, where no broadcast
// file of the day is at hand, or where broadcast errors of a metre are not wanted.

#include <map>
#include <string>
#include <vector>

#include "fsw/core/gps_time.h"
#include "host_sim/orbit_files/orbit_file.h"
#include "host_sim/twins/gnss/constellation.h"
#include "host_sim/twins/gnss/satellite.h"

namespace vbar::flown_gnss {

struct FitSettings {
  double period_s = 7200.0;     ///< between reference times, multiples of it since the begin of the week
  double orbit_arc_s = 9000.0;  ///< positions at most half of it from the reference time
  double clock_arc_s = 7200.0;  ///< clocks, likewise
};

/// Distance of the antenna's phase centre from the centre of mass towards the Earth, m, by satellite: the precise orbit
/// is that of the centre of mass, the broadcast one that of the antenna. The offset across it (0.28 m and below, 7 cm
/// in range) is neglected.
using PhaseCentres = std::map<int, double>;

struct FittedSet {
  twins::gnss::Ephemeris elements;
  double orbit_rms_m = 0.0, orbit_max_m = 0.0;  ///< distance from the positions of the arc
  double clock_rms_m = 0.0, clock_max_m = 0.0;
};

struct Fit {
  std::vector<FittedSet> sets;        ///< in order of reference time, then of satellite
  std::vector<std::string> left_out;  ///< "G25 at 2010-07-27 ...: no clock": sets that could not be fitted
};

/// Fits the sets of the GPS satellites of `tracks`, which are those of consecutive files: of each satellite at each
/// reference time within its positions. Throws std::runtime_error for tracks that hold no GPS satellite.
[[nodiscard]] Fit fit_ephemerides(const std::vector<orbit_files::OrbitFile>& files, const FitSettings& settings,
                                  const PhaseCentres& phase_centres);

/// Reads the offsets of the GPS satellites that are in orbit at `time` from a file in ANTEX format (Rothacher, Schmid
/// 2010: version 1.4): those of L1 and L2 combined to that of the ionosphere-free range. Throws files::FormatError.
[[nodiscard]] PhaseCentres read_phase_centres(std::string_view text, const std::string& file, fsw::GpsTime time);

/// Returns sets as a RINEX navigation file of version 3.04, with the ionosphere of `corrections` unless that is zero.
[[nodiscard]] std::string rinex_navigation(const std::vector<FittedSet>& sets,
                                           const twins::gnss::BroadcastCorrections& corrections = {});

}  // namespace vbar::flown_gnss
