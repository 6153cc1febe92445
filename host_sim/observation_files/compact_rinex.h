#pragma once
// Compact RINEX (Hatanaka 2008: "A compression format and tools for GNSS observation data"), versions 1.0 (of RINEX 2)
// and 3.0 (of RINEX 3): epochs as changes of their text, observations as differences in time of up to ninth order.

#include <string>
#include <string_view>

namespace vbar::observation_files {

[[nodiscard]] bool is_compact_rinex(std::string_view text);

/// Returns the RINEX file that was compressed, byte by byte but for blanks at the end of its lines. Throws
/// files::FormatError for a text that is not one, and for one that is longer than files::kLargestText.
[[nodiscard]] std::string expand_compact_rinex(std::string_view text, const std::string& file);

}  // namespace vbar::observation_files
