#pragma once
// The records of a RINEX navigation file after its header.

#include <optional>

#include "host_sim/files/text_lines.h"
#include "host_sim/twins/gnss/formats/ephemeris_formats.h"

namespace vbar::twins::gnss {

/// Goes through the records of a file of version 2, 3 or 4 behind its header.
class RinexRecords {
 public:
  /// `lines` must outlive it.
  RinexRecords(files::TextLines& lines, int version) : lines_(lines), version_(version) { advance(); }

  /// The next set of a satellite that flies here; nothing at the end. Corrections of version 4 go to `corrections`.
  /// Throws files::FormatError.
  std::optional<BroadcastRecord> next(BroadcastCorrections& corrections);

 private:
  void advance() { has_line_ = lines_.next(); }
  void skip_record();
  void need_line(std::string_view of_what);
  [[nodiscard]] bool begins_record() const;
  std::optional<BroadcastRecord> read_set();
  void read_frame(BroadcastCorrections& corrections);
  void read_ionosphere(BroadcastCorrections& corrections);
  void read_utc(BroadcastCorrections& corrections);

  files::TextLines& lines_;
  int version_;
  bool has_line_ = false;
};

}  // namespace vbar::twins::gnss
