#include "host_sim/truth/earth/sections.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace vbar::truth {

bool Sections::take(const files::TextLines& lines) {
  const std::string_view line = files::trimmed(lines.line());
  const bool begins = line.starts_with("BEGIN ");
  if (!begins && !line.starts_with("END ")) return false;
  const auto found = std::ranges::find(names_, line.substr(line.find(' ') + 1));
  if (found == names_.end()) lines.refuse(fmt::format("BEGIN or END of one of {}", fmt::join(names_, ", ")));
  const auto place = static_cast<std::size_t>(found - names_.begin());
  if (begins == open_.has_value() || (!begins && *open_ != place))
    lines.refuse("BEGIN and END of one section after the other");
  open_ = begins ? std::optional(place) : std::nullopt;
  return true;
}

void Sections::check_end(const files::TextLines& lines) const {
  if (open_) lines.refuse("the end of the file", "the END of the section");
}

}  // namespace vbar::truth
