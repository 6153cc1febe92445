#pragma once
// Status of a campaign, for a reader.

#include <string>
#include <vector>

#include "host_sim/campaign/case_state.h"

namespace vbar::campaign {

/// Counts of states, passed cases, the requirement, the most frequent reasons of failure, workers, jobs, damaged lines.
[[nodiscard]] std::string status_text(const Standing& standing, const std::vector<std::string>& jobs);

}  // namespace vbar::campaign
