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

// Search of a reference by a word.

/// Quality of the match of a text with a search, in ascending order.
enum class Match {
  kNone,
  kWordStart,  ///< a word of the text begins with it: "hold" and "holdover"
  kWord,       ///< a whole word: "hold" and "guidance.hold_distance_m"
};

/// Matches `searched` against a text. Letters and digits form words, and case does not count: "hold" is in
/// "hold_distance_m" but not in "threshold". A search of several words ("keep_out", "of the target") matches where they
/// follow each other in that order. An empty search matches all.
[[nodiscard]] Match match_of(std::string_view searched, std::string_view text);

/// Returns " (did you mean WORD?)" for a search without a result, of the names searched, their parts between dots and
/// spaces, and the words of these; empty without a near one.
[[nodiscard]] std::string word_meant(std::string_view searched, const std::vector<std::string>& names);

}  // namespace vbar::mission
