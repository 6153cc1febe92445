#include "host_sim/mission/name_search.h"

#include <algorithm>
#include <cctype>

namespace vbar::mission {

namespace {

// Optimal string alignment distance (Damerau-Levenshtein without editing a swapped pair again).
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) d[i][0] = i;
  for (std::size_t j = 0; j <= b.size(); ++j) d[0][j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replace = d[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      d[i][j] = std::min({replace, d[i - 1][j] + 1, d[i][j - 1] + 1});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  }
  return d[a.size()][b.size()];
}

}  // namespace

std::optional<std::string_view> nearest_name(std::string_view word, const std::vector<std::string_view>& names) {
  std::optional<std::string_view> nearest;
  std::size_t least = (word.size() + 2) / 3 + 1;
  for (const std::string_view name : names) {
    const std::size_t distance = edit_distance(word, name);
    if (distance < least) {
      least = distance;
      nearest = name;
    }
  }
  return nearest;
}

std::string did_you_mean(std::string_view word, const std::vector<std::string_view>& names) {
  const auto nearest = nearest_name(word, names);
  return nearest ? " (did you mean " + std::string(*nearest) + "?)" : std::string();
}

namespace {

bool is_word_letter(char letter) {
  return std::isalnum(static_cast<unsigned char>(letter)) != 0;
}

bool is_same_letter(char a, char b) {
  return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
}

/// Whether no word goes across the place before letter `k`.
bool is_boundary(std::string_view text, std::size_t k) {
  return k == 0 || k >= text.size() || !is_word_letter(text[k - 1]) || !is_word_letter(text[k]);
}

void add_parts(std::string_view name, std::string_view separators, std::vector<std::string_view>& parts) {
  while (!name.empty()) {
    const std::size_t end = std::min(name.find_first_of(separators), name.size());
    if (end > 0) parts.push_back(name.substr(0, end));
    name.remove_prefix(std::min(end + 1, name.size()));
  }
}

}  // namespace

Match match_of(std::string_view searched, std::string_view text) {
  if (searched.empty()) return Match::kWord;
  Match best = Match::kNone;
  for (auto from = text.begin();; ++from) {
    from = std::search(from, text.end(), searched.begin(), searched.end(), is_same_letter);
    if (from == text.end()) return best;
    const auto first = static_cast<std::size_t>(from - text.begin());
    if (!is_boundary(text, first)) continue;
    if (is_boundary(text, first + searched.size())) return Match::kWord;
    best = Match::kWordStart;
  }
}

std::string word_meant(std::string_view searched, const std::vector<std::string>& names) {
  std::vector<std::string_view> parts(names.begin(), names.end());
  for (const char* const separators : {". ", "._ "})
    for (const std::string& name : names) add_parts(name, separators, parts);
  return did_you_mean(searched, parts);
}

}  // namespace vbar::mission
