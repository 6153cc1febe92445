#pragma once
// "0-99,417": numbers of cases on the command line.

#include <cstddef>
#include <string>
#include <vector>

namespace vbar::campaign {

/// Returns the numbers, sorted. Throws app::Refused unless all are below `cases`.
[[nodiscard]] std::vector<std::size_t> selected_cases(const std::string& text, std::size_t cases);

}  // namespace vbar::campaign
