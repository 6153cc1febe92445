#pragma once
// Record of a propagation without flight software.

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "fsw/core/gps_time.h"
#include "fsw/orbit/elements.h"
#include "host_sim/files/output_file.h"
#include "host_sim/truth/earth/earth_rotation.h"
#include "host_sim/truth/truth_model.h"

namespace vbar::report {

/// One spacecraft at one sampling time.
struct EphemerisRow {
  fsw::GpsTime time;
  double time_s = 0.0;               ///< since the mission's epoch
  fsw::orbit::CartesianState state;  ///< GCRF
  truth::GeodeticPosition geodetic;  ///< WGS 84
};

struct PropagatedSpacecraft {
  std::string name;
  double first_altitude_m = 0.0;                           ///< above WGS 84, at the start
  double last_altitude_m = 0.0;                            ///< and at the last sampling time
  std::optional<double> semi_major_axis_change_by_drag_m;  ///< over the flight, below 0; nothing without drag
  truth::TruthStatistics statistics;
};

struct PropagationRecord {
  std::string mission;
  bool complete = false;
  std::string incomplete_reason;
  double simulated_s = 0.0;
  double wall_s = 0.0;  ///< wall time of the propagation, files included
  int threads = 1;
  std::vector<std::string> data_notes;  ///< on data that are missing, predicted or used in part
  std::vector<PropagatedSpacecraft> spacecraft;
  truth::TruthStatistics total;
  std::vector<truth::ForceTime> force_times;  ///< with that of "sampling" last; summed over spacecraft and so threads
};

// A spacecraft's ephemeris as a CSV file, one row a sampling time.

/// Columns: time_s (since the epoch), utc, position_eci_{x,y,z}_m, velocity_eci_{x,y,z}_mps (GCRF), latitude_deg,
/// longitude_deg, altitude_m (WGS 84). Numbers read back as the same bits.
class EphemerisCsv {
 public:
  /// Throws std::runtime_error that names the file, as the others do.
  explicit EphemerisCsv(const std::filesystem::path& file);
  void append(const EphemerisRow& row);
  void flush() { file_.flush(); }
  void finish() { file_.finish(); }

 private:
  files::ReleasedFile file_;
};

// A spacecraft's ephemeris as a CCSDS Orbit Ephemeris Message in keyword = value notation (CCSDS 502.0-B-2, section 5),
// which flight dynamics programs read.

/// One message with one segment: centre Earth, frame GCRF, time system UTC, km and km/s to a micrometre and a
/// micrometre a second. Interpolation is advised by Hermite polynomials of degree 7, or less if there are fewer states.
class OemFile {
 public:
  struct Span {
    fsw::GpsTime start;      ///< time of the first row
    fsw::GpsTime stop;       ///< time of the last row
    std::size_t states = 2;  ///< how many rows there will be
    fsw::GpsTime created;    ///< when the file is made
  };

  /// `object`: name of the spacecraft, which is its identifier as well: simulated ones have no international
  /// designator. Throws std::runtime_error that names the file, as the others do.
  OemFile(const std::filesystem::path& file, const std::string& object, const Span& span);

  /// Rows in order of time.
  void append(const EphemerisRow& row);
  void flush() { file_.flush(); }
  void finish() { file_.finish(); }

 private:
  files::ReleasedFile file_;
};

// A propagation in short: as a table for people and as JSON for programs.

/// One line a spacecraft, then where the time went, then the speed.
[[nodiscard]] std::string propagation_table(const PropagationRecord& record);

/// `files`: names of the ephemeris files beside it.
[[nodiscard]] std::string propagation_json(const PropagationRecord& record, std::span<const std::string> files);

// The folder that a propagation leaves: propagation.json, and for each spacecraft its ephemeris. As a run's folder it
// says that it is incomplete from the moment it exists until all is known to be whole.

class PropagationFolder {
 public:
  /// Makes the folder. What an earlier propagation left there, by its own list, is removed. Throws std::runtime_error
  /// that names the folder if it holds anything but a propagation, or cannot be made or written.
  PropagationFolder(std::filesystem::path folder, const std::string& mission);

  /// Starts `<name>.csv` of each spacecraft, and `<name>.oem` if `oem` is given.
  void start_files(std::span<const std::string> names, const OemFile::Span* oem);

  /// Appends a row to the ephemeris of a spacecraft, given by its place among the names. From any thread, one at a time
  /// for one spacecraft.
  void append(std::size_t spacecraft, const EphemerisRow& row);

  /// Gives the files their names if the propagation is complete, then writes propagation.json.
  void finish(const PropagationRecord& record);

  [[nodiscard]] const std::filesystem::path& path() const { return folder_; }

 private:
  std::filesystem::path folder_;
  std::vector<std::string> file_names_;
  std::vector<EphemerisCsv> csv_;
  std::vector<OemFile> oem_;
};

/// Returns the default folder of a propagation: runs/<mission>-truth.
[[nodiscard]] std::filesystem::path default_propagation_folder(const std::string& mission);

}  // namespace vbar::report
