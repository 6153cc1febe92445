#include "host_sim/campaign/case_selection.h"

#include <charconv>
#include <set>
#include <string_view>

#include <fmt/format.h>

#include "host_sim/app/exit_codes.h"

namespace vbar::campaign {
namespace {

bool read_number(std::string_view digits, std::size_t& number) {
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  return error == std::errc{} && end == digits.data() + digits.size();
}

}  // namespace

std::vector<std::size_t> selected_cases(const std::string& text, std::size_t cases) {
  std::set<std::size_t> selected;
  for (std::size_t place = 0; place <= text.size();) {
    const std::size_t comma = std::min(text.find(',', place), text.size());
    const std::string_view part = std::string_view(text).substr(place, comma - place);
    const std::size_t dash = std::min(part.find('-'), part.size());
    std::size_t first = 0, last = 0;
    const bool is_good = read_number(part.substr(0, dash), first) &&
                         read_number(dash == part.size() ? part : part.substr(dash + 1), last) && first <= last &&
                         last < cases;
    if (!is_good)
      throw app::Refused(fmt::format("--cases: found \"{}\"; accepted: numbers and ranges from 0 to {}, e.g. 0-9,17",
                                     part, cases - 1));
    for (std::size_t number = first; number <= last; ++number) selected.insert(number);
    place = comma + 1;
  }
  return {selected.begin(), selected.end()};
}

}  // namespace vbar::campaign
