#pragma once
// Reads broadcast ephemerides: those of data/gps, RINEX navigation files (ephemeris_formats()).

#include <filesystem>
#include <string>
#include <vector>

#include "host_sim/twins/gnss/broadcast_orbit.h"
#include "host_sim/twins/gnss/constellation.h"

namespace vbar::twins::gnss {

struct EphemerisFile {
  std::vector<Ephemeris> satellites;  ///< for the day of the file
  BroadcastCorrections corrections;   ///< zero if missing in the file
  std::string note;                   ///< content of the file beside them, with its name; empty: none
};

/// Reads the satellites of the systems in `used`; records of others are not looked at. Throws std::runtime_error naming
/// file, line and what is accepted.
EphemerisFile read_ephemeris_file(const std::filesystem::path& file, const SystemSet& used = kAllSystems);

}  // namespace vbar::twins::gnss
