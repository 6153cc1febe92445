#pragma once
// RINEX observation files, versions 2.xx, 3.xx and 4.xx: what a receiver recorded, epoch by epoch.

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "fsw/core/gps_time.h"
#include "host_sim/files/text_lines.h"
#include "host_sim/observation_files/observation_types.h"
#include "host_sim/orbit_files/published_time.h"

namespace vbar::observation_files {

/// One field of a satellite; 0: missing, as the format has it.
struct ObservedValue {
  double value = 0.0;             ///< m, cycles, Hz or as the receiver states signal strength
  std::uint8_t loss_of_lock = 0;  ///< bit 0: lock was lost since the last epoch; bit 1: half cycles are ambiguous
  std::uint8_t strength = 0;      ///< 1 to 9; 0: unknown
};

struct SatelliteObservations {
  char system = 'G';
  int number = 0;
  std::vector<ObservedValue> values;  ///< in the order of the types of the system
};

struct RecordedEpoch {
  fsw::GpsTime time;  ///< by the receiver's clock
  bool after_power_failure = false;
  std::shared_ptr<const ObservationTypes> types;
  std::vector<SatelliteObservations> satellites;

  /// Returns the value of the type `name` of a satellite; a missing one for a type that the file lacks.
  [[nodiscard]] ObservedValue value(const SatelliteObservations& satellite, std::string_view name) const;
};

/// Records of a file that are not epochs of observations.
struct ObservationCounts {
  std::size_t epochs = 0;
  std::size_t power_failures = 0;  ///< flag 1
  std::size_t events = 0;          ///< flags 2 to 5: moving antenna, new site, header lines, external event
  std::size_t slip_records = 0;    ///< flag 6; the next observation of each phase has its loss of lock set
};

/// Goes through the epochs of a text, which must outlive it. All functions throw files::FormatError, one sentence
/// "file:line: found ..., expected ...".
class ObservationReader {
 public:
  /// Reads the header.
  ObservationReader(std::string_view text, const std::string& file);

  /// Returns the next epoch of observations, in ascending order of time; nothing behind the last one.
  [[nodiscard]] std::optional<RecordedEpoch> next();

  [[nodiscard]] const ObservationCounts& counts() const { return counts_; }
  [[nodiscard]] double interval_s() const { return interval_s_; }  ///< 0: not stated
  [[nodiscard]] const std::string& marker() const { return marker_; }

  static constexpr int kMaxSatellites = 200;  ///< in one epoch

 private:
  struct EpochLine {
    int flag = 0;
    int count = 0;  ///< satellites, or lines of an event
    std::optional<fsw::GpsTime> time;
  };

  void read_header();
  void take_header_line();
  void need_line(std::string_view of_what);
  [[nodiscard]] EpochLine read_epoch_line() const;
  [[nodiscard]] std::pair<char, int> satellite_in(std::size_t column) const;
  [[nodiscard]] std::vector<std::pair<char, int>> satellites_of_version_2(int count);
  void skip_event(const EpochLine& line);
  [[nodiscard]] std::vector<SatelliteObservations> read_satellites(int count);
  void read_values(SatelliteObservations& satellite, std::size_t first_column, std::size_t per_line);
  void note_slips(const std::vector<SatelliteObservations>& satellites);
  void apply_slips(RecordedEpoch& epoch);

  files::TextLines lines_;
  std::shared_ptr<ObservationTypes> types_;
  ObservationCounts counts_;
  char default_system_ = 'G';
  double interval_s_ = 0.0;
  std::string marker_;
  orbit_files::TimeSystem time_system_ = orbit_files::TimeSystem::kGps;
  std::optional<fsw::GpsTime> last_;
  std::set<std::pair<std::pair<char, int>, std::size_t>> slips_;  ///< satellite and place of its type
};

/// Whether the text is a RINEX or a compact RINEX observation file, by its first line.
[[nodiscard]] bool is_observation_file(std::string_view text);

/// Returns the text of an observation file as ObservationReader reads it: compact RINEX is expanded, any other text
/// returned as it is. Throws files::FormatError.
[[nodiscard]] std::string plain_observations(std::string text, const std::string& file);

// Compact RINEX (Hatanaka 2008: "A compression format and tools for GNSS observation data"), versions 1.0 (of RINEX 2)
// and 3.0 (of RINEX 3): epochs as changes of their text, observations as differences in time of up to ninth order.

[[nodiscard]] bool is_compact_rinex(std::string_view text);

/// Returns the RINEX file that was compressed, byte by byte but for blanks at the end of its lines. Throws
/// files::FormatError for a text that is not one, and for one that is longer than files::kLargestText.
[[nodiscard]] std::string expand_compact_rinex(std::string_view text, const std::string& file);

}  // namespace vbar::observation_files
