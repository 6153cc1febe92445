#pragma once
// Orbits from files in published formats: each format is recognised by its contents, whatever the name of the file;
// each has its file here and its line in the list.

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "fsw/core/gps_time.h"
#include "fsw/orbit/elements.h"

namespace vbar::orbit_files {

enum class Frame { kGcrf, kItrf };

struct TimedState {
  fsw::GpsTime time;
  fsw::orbit::CartesianState state;  ///< in the frame of the track; of an Earth-fixed one relative to that frame
};

/// States of one object that follow each other, at least one.
struct Track {
  std::string object{};   ///< name in the file
  std::string object_id;  ///< another name, may be empty
  Frame frame = Frame::kGcrf;
  bool has_velocities = true;
  double largest_step_s = 0.0;  ///< more than it between two states is a gap; 0: there are none
  std::vector<TimedState> states{};
};

struct OrbitFile {
  std::string file;
  std::string format;
  std::vector<Track> tracks;
};

struct OrbitFormat {
  std::string_view name;
  bool (*recognises)(std::string_view text);
  std::vector<Track> (*read)(std::string_view text, const std::string& file);  ///< throws files::FormatError
};

// CCSDS Orbit Ephemeris Message (502.0-B-3, section 5) in KVN: REF_FRAME GCRF, ICRF or EME2000, TIME_SYSTEM UTC, TAI,
// TT or GPS. Covariances are skipped.
[[nodiscard]] bool is_oem(std::string_view text);
[[nodiscard]] std::vector<Track> read_oem(std::string_view text, const std::string& file);

// CCSDS Orbit Parameter Message (502.0-B-3, section 3) in KVN, the same frames and time systems: its state vector. A
// message with maneuvers is refused; osculating elements, spacecraft parameters and covariance are skipped.
[[nodiscard]] bool is_opm(std::string_view text);
[[nodiscard]] std::vector<Track> read_opm(std::string_view text, const std::string& file);

// SP3-a to SP3-d (Hilla 2016), Earth-fixed, with or without velocities. Positions of 0 are missing ones.
[[nodiscard]] bool is_sp3(std::string_view text);
[[nodiscard]] std::vector<Track> read_sp3(std::string_view text, const std::string& file);

[[nodiscard]] std::span<const OrbitFormat> orbit_formats();

/// The tracks of a text in any of the formats. Throws files::FormatError; for an unknown format it names all.
[[nodiscard]] OrbitFile read_orbits(std::string_view text, const std::string& file);

/// The same of a file, which becomes part of the run's provenance. Throws std::runtime_error.
[[nodiscard]] OrbitFile load_orbits(const std::filesystem::path& file);

/// The tracks of one object: that named `object`, or, if `object` is empty, the only one of the file. Throws
/// std::runtime_error that names the objects of the file.
[[nodiscard]] OrbitFile tracks_of(const OrbitFile& file, std::string_view object);

/// A state and the frame it is in.
struct FramedState {
  Frame frame = Frame::kGcrf;
  fsw::orbit::CartesianState state;
};

/// State at `time` of a file of one object, interpolated: with velocities by the Hermite polynomial through four
/// states, else by that of degree 9 through ten positions. Throws std::out_of_range that names file, time and range,
/// also in a gap.
[[nodiscard]] FramedState state_at(const OrbitFile& file, fsw::GpsTime time);

}  // namespace vbar::orbit_files
