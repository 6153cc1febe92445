#pragma once
// The records of a RINEX navigation file after its header.

#include <optional>
#include <string_view>

#include "host_sim/files/text_lines.h"
#include "host_sim/twins/gnss/formats/ephemeris_formats.h"
#include "host_sim/twins/gnss/formats/left_out.h"

namespace vbar::twins::gnss {

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
