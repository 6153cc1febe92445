#pragma once
// The header of a RINEX navigation file.

#include "host_sim/files/text_lines.h"
#include "host_sim/twins/gnss/constellation.h"

namespace vbar::twins::gnss {

struct RinexHeader {
  int version = 0;  ///< 2, 3 or 4
  BroadcastCorrections corrections;
};

/// Reads up to END OF HEADER. Throws files::FormatError, also for observation files and for files of systems other than
/// GPS, Galileo and BeiDou.
[[nodiscard]] RinexHeader read_rinex_header(files::TextLines& lines);

}  // namespace vbar::twins::gnss
