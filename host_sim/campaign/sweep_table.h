#pragma once
// A sweep of a CSV table: a head of mission keys, then a row of values for each sweep point.

#include <filesystem>
#include <string_view>

#include "host_sim/campaign/campaign_file.h"

namespace vbar::campaign {

/// `key` of `section` names the file. Throws MissionError that names file, line and what is accepted.
[[nodiscard]] Sweep read_sweep_table(const mission::TableReader& section, std::string_view key,
                                     const std::filesystem::path& file);

}  // namespace vbar::campaign
