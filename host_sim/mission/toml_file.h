#pragma once
// How deep the tables and arrays of a TOML text are nested. A parser of such trees, and what walks through them later,
// calls itself once for each level: the depth has to be known to be small before the text is parsed.

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include <toml++/toml.h>

namespace vbar::mission {

/// Deepest nesting that is accepted; that of mission files is below ten.
inline constexpr std::size_t kTomlDepthMax = 100;

/// Returns the line, counted from 1, where `text` nests deeper than kTomlDepthMax by dotted keys, table headers, inline
/// tables and arrays together; nothing if no line does. The result for a text that is not TOML has no meaning.
[[nodiscard]] std::optional<std::size_t> line_too_deep(std::string_view text);

// TOML text and files to tables, with MissionErrors for invalid input.

/// Parses a TOML document. `file`: its name, for messages.
[[nodiscard]] toml::table parse_toml(std::string_view text, const std::string& file);

/// Returns the text of a file; `kind` is the expected kind: "a mission file (TOML)".
[[nodiscard]] std::string read_text_file(const std::filesystem::path& file, const std::string& kind);

/// Returns the text of a data file, which becomes part of the run's provenance (host_sim/files/data_stream.h).
[[nodiscard]] std::string read_data_text(const std::filesystem::path& file, const std::string& kind);

}  // namespace vbar::mission
