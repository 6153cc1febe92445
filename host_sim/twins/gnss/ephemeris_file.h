#pragma once
// Reads broadcast ephemerides: those of data/gps, RINEX navigation files (ephemeris_formats()).

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "host_sim/twins/gnss/constellation.h"
#include "host_sim/twins/gnss/satellite.h"

namespace vbar::twins::gnss {

struct EphemerisFile {
  std::vector<Ephemeris> satellites;  ///< for the day of the file
  BroadcastCorrections corrections;   ///< zero if missing in the file
  std::string note;                   ///< content of the file beside them, with its name; empty: none
};

/// Reads the satellites of the systems in `used`; records of others are not looked at. Throws std::runtime_error naming
/// file, line and what is accepted.
EphemerisFile read_ephemeris_file(const std::filesystem::path& file, const SystemSet& used = kAllSystems);

// The formats of broadcast ephemerides that are read as published. Each is recognised by its contents; each has its
// functions here and its line in the list.

struct EphemerisFormat {
  std::string_view name;
  bool (*recognises)(std::string_view text);
  /// Throws std::runtime_error.
  EphemerisFile (*read)(std::string_view text, const std::string& file, const SystemSet& used);
};

// Table of this project, data/gps.
[[nodiscard]] bool is_ephemeris_table(std::string_view text);
[[nodiscard]] EphemerisFile read_ephemeris_table(std::string_view text, const std::string& file, const SystemSet& used);

// RINEX navigation files, versions 2.xx (GPS), 3.xx and 4.xx (GPS LNAV, Galileo I/NAV, BeiDou D1 and D2). Left out, and
// named in the note, are records of other systems and messages, and sets that cannot be read or cannot be right, as
// merged files hold some. One set of each satellite is used: that whose reference time is nearest to noon of the file's
// day, which is the day of the median reference time. Files whose records have no valid structure are rejected, and so
// are those with no set of the systems in use and nothing of another system.
[[nodiscard]] bool is_rinex(std::string_view text);
[[nodiscard]] EphemerisFile read_rinex(std::string_view text, const std::string& file, const SystemSet& used);

/// Reads all sets of a RINEX navigation file, in the order of the file.
[[nodiscard]] EphemerisFile read_rinex_sets(std::string_view text, const std::string& file, const SystemSet& used);

[[nodiscard]] std::span<const EphemerisFormat> ephemeris_formats();

/// Reads the satellites of a text in any of the formats. Throws std::runtime_error; for an unknown format it names all.
[[nodiscard]] EphemerisFile read_ephemerides(std::string_view text, const std::string& file,
                                             const SystemSet& used = kAllSystems);

/// One set in the terms of the navigation message: week and seconds of week of its system.
struct BroadcastRecord {
  SatelliteId satellite;
  double week = 0.0, toe_s = 0.0;
  double toc_s = 0.0;    ///< time in the same week: below 0 or beyond its end in the weeks beside
  double omega0 = 0.0;   ///< at the begin of the week
  Ephemeris elements{};  ///< all but reference time, node and clock
  double af0 = 0.0, af1 = 0.0, af2 = 0.0;
};

/// Longest time between the reference times of clock and orbit.
inline constexpr double kLongestClockAge_s = 86400.0;

/// Largest eccentricity. Galileo has two satellites at 0.16 (E14, E18); the flight software rejects more.
inline constexpr double kMaxEccentricity = 0.2;

/// Returns the defect of a record; empty if it has none.
[[nodiscard]] std::string problem_of(const BroadcastRecord& record);

/// Returns the set with the clock's reference time moved to toe. The record must have no problem.
[[nodiscard]] Ephemeris ephemeris_of(const BroadcastRecord& record);

}  // namespace vbar::twins::gnss
