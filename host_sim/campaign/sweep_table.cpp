#include "host_sim/campaign/sweep_table.h"

#include <fmt/format.h>

#include "host_sim/mission/mission_error.h"
#include "host_sim/report/csv_table.h"

namespace vbar::campaign {

Sweep read_sweep_table(const mission::TableReader& section, std::string_view key, const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error))
    section.refuse_value(key, "a CSV file, seen from the campaign file");
  Sweep sweep;
  const std::vector<std::string> lines = report::read_lines(file);
  for (std::size_t number = 0; number < lines.size(); ++number) {
    if (lines[number].empty()) continue;
    std::vector<std::string> cells;
    const bool is_row = report::split_cells(lines[number], cells);
    if (!is_row || (!sweep.keys.empty() && cells.size() != sweep.keys.size()))
      throw mission::MissionError(fmt::format("{}:{}", file.string(), number + 1), "",
                                  fmt::format("{} cells", is_row ? cells.size() : 0),
                                  fmt::format("a row of {} cells", sweep.keys.empty() ? 1 : sweep.keys.size()));
    if (sweep.keys.empty())
      sweep.keys = cells;
    else
      sweep.rows.push_back(cells);
  }
  if (sweep.rows.empty()) section.refuse_value(key, "a table of mission keys in the first line and at least one row");
  return sweep;
}

}  // namespace vbar::campaign
