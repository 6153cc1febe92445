#pragma once
// TOML text and files to tables, with MissionErrors for invalid input.

#include <filesystem>
#include <string>
#include <string_view>

#include <toml++/toml.h>

namespace vbar::mission {

/// Parses a TOML document. `file`: its name, for messages.
[[nodiscard]] toml::table parse_toml(std::string_view text, const std::string& file);

/// Returns the text of a file; `kind` is the expected kind: "a mission file (TOML)".
[[nodiscard]] std::string read_text_file(const std::filesystem::path& file, const std::string& kind);

/// Returns the text of a data file, which becomes part of the run's provenance (host_sim/files/data_stream.h).
[[nodiscard]] std::string read_data_text(const std::filesystem::path& file, const std::string& kind);

}  // namespace vbar::mission
