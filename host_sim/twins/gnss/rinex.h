#pragma once
// What a navigation file holds beside the sets that are used, by kind and number, for a note and for the refusal of a
// file without a set that can be used.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host_sim/files/text_lines.h"
#include "host_sim/twins/gnss/constellation.h"
#include "host_sim/twins/gnss/ephemeris_file.h"

namespace vbar::twins::gnss {

class LeftOut {
 public:
  /// Adds a record of another system or message, which every file of several systems holds: "GLONASS", "Galileo F/NAV".
  void add(std::string_view kind) { entry(kind).count += 1; }

  /// Adds a set that would be used if it were right. `first`: satellite, line and reason, kept of the first of its
  /// kind.
  void add_defective(std::string_view kind, const std::string& first);

  [[nodiscard]] bool is_empty() const { return entries_.empty(); }

  /// Returns the records left out in words: "GLONASS (210), Galileo F/NAV (12), sets of zeros (2; the first: G05 in
  /// line 19)".
  [[nodiscard]] std::string text() const;

 private:
  struct Entry {
    std::string kind, first;
    int count = 0;
  };
  Entry& entry(std::string_view kind);

  std::vector<Entry> entries_;  ///< in the order in which their kinds appear
};

// The header of a RINEX navigation file.

struct RinexHeader {
  int version = 0;  ///< 2, 3 or 4
  BroadcastCorrections corrections;
};

/// Reads up to END OF HEADER. Throws files::FormatError, also for observation files and for files of systems other than
/// GPS, Galileo and BeiDou.
[[nodiscard]] RinexHeader read_rinex_header(files::TextLines& lines);

// The records of a RINEX navigation file after its header.

/// Goes through the records of a file of version 2, 3 or 4 behind its header.
class RinexRecords {
 public:
  /// Makes a reader. `lines` must outlive it. `used`: the systems whose sets are read.
  RinexRecords(files::TextLines& lines, int version, const SystemSet& used)
      : lines_(lines), version_(version), used_(used) {
    advance();
  }

  /// Reads the next set that can be used; nothing at the end. Corrections of version 4 go to `corrections`. Throws
  /// files::FormatError.
  std::optional<BroadcastRecord> next(BroadcastCorrections& corrections);

  [[nodiscard]] const LeftOut& left_out() const { return left_out_; }
  [[nodiscard]] bool has_unused_systems() const { return has_unused_systems_; }
  [[nodiscard]] int sets_with_resolved_week() const { return sets_with_resolved_week_; }

 private:
  void advance() { has_line_ = lines_.next(); }
  void skip_record();
  void need_line(std::string_view of_what);
  [[nodiscard]] bool begins_record() const;
  std::optional<BroadcastRecord> read_frame(BroadcastCorrections& corrections);
  std::optional<BroadcastRecord> read_record();
  std::optional<BroadcastRecord> read_set(SatelliteId satellite);
  void read_ionosphere(BroadcastCorrections& corrections);
  void read_utc(BroadcastCorrections& corrections);

  files::TextLines& lines_;
  int version_;
  SystemSet used_;
  LeftOut left_out_;
  bool has_line_ = false, has_unused_systems_ = false;
  int sets_with_resolved_week_ = 0;
};

}  // namespace vbar::twins::gnss
