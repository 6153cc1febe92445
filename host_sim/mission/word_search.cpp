#include "host_sim/mission/word_search.h"

#include <algorithm>
#include <cctype>

#include "host_sim/mission/nearest_name.h"

namespace vbar::mission {
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
