#pragma once
// Reads broadcast ephemerides: those of data/gps, RINEX navigation files (formats/ephemeris_formats.h).

#include <filesystem>
#include <vector>

#include "host_sim/twins/gnss/broadcast_orbit.h"
#include "host_sim/twins/gnss/constellation.h"

namespace vbar::twins::gnss {

struct EphemerisFile {
  std::vector<Ephemeris> satellites;  ///< for the day of the file
  BroadcastCorrections corrections;   ///< zero if missing in the file
};

/// Throws std::runtime_error naming file, line and what is accepted.
EphemerisFile read_ephemeris_file(const std::filesystem::path& file);

}  // namespace vbar::twins::gnss
