#pragma once
// How deep the tables and arrays of a TOML text are nested. A parser of such trees, and what walks through them later,
// calls itself once for each level: the depth has to be known to be small before the text is parsed.

#include <cstddef>
#include <optional>
#include <string_view>

namespace vbar::mission {

/// Deepest nesting that is accepted; that of mission files is below ten.
inline constexpr std::size_t kTomlDepthMax = 100;

/// Returns the line, counted from 1, where `text` nests deeper than kTomlDepthMax by dotted keys, table headers, inline
/// tables and arrays together; nothing if no line does. The result for a text that is not TOML has no meaning.
[[nodiscard]] std::optional<std::size_t> line_too_deep(std::string_view text);

}  // namespace vbar::mission
