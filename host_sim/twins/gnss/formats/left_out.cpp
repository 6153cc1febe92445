#include "host_sim/twins/gnss/formats/left_out.h"

#include <algorithm>

#include <fmt/format.h>

namespace vbar::twins::gnss {

LeftOut::Entry& LeftOut::entry(std::string_view kind) {
  constexpr std::size_t kMaxKinds = 40;  // systems and messages that exist; a damaged file may name any number
  const auto found = std::ranges::find(entries_, kind, &Entry::kind);
  if (found != entries_.end()) return *found;
  if (entries_.size() == kMaxKinds) return entries_.back();
  entries_.push_back({std::string(kind), {}, 0});
  return entries_.back();
}

void LeftOut::add_defective(std::string_view kind, const std::string& first) {
  Entry& one = entry(kind);
  one.count += 1;
  if (one.first.empty()) one.first = first;
}

std::string LeftOut::text() const {
  std::string text;
  for (const Entry& one : entries_) {
    if (!text.empty()) text += ", ";
    text += fmt::format("{} ({}", one.kind, one.count);
    if (!one.first.empty()) text += fmt::format("; {}{}", one.count > 1 ? "the first: " : "", one.first);
    text += ")";
  }
  return text;
}

}  // namespace vbar::twins::gnss
