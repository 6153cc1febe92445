#pragma once
// "Did you mean ...?"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace vbar::mission {

/// Returns the name among `names` nearest to `word` by edit distance (insert, delete, replace, swap of neighbours), the
/// first of equals; empty if all are further than a third of the word's length, rounded up.
[[nodiscard]] std::optional<std::string_view> nearest_name(std::string_view word,
                                                           const std::vector<std::string_view>& names);

/// Returns " (did you mean NAME?)" with the nearest name, for a message; empty without one.
[[nodiscard]] std::string did_you_mean(std::string_view word, const std::vector<std::string_view>& names);

}  // namespace vbar::mission
