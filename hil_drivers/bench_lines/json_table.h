#pragma once
// Command on a control line: a JSON object with the keys of a table in the scenario file of the emulator.

#include <string>
#include <string_view>

#include <toml++/toml.h>

namespace vbar::bench_lines {

/// Returns the table of a JSON object whose values are numbers and texts. `where` and `example` stand in the message.
/// Throws mission::MissionError.
[[nodiscard]] toml::table table_of_json(const std::string& line, const std::string& where, std::string_view example);

}  // namespace vbar::bench_lines
