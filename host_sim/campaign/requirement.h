#pragma once
// Requirement on a campaign as a whole.

#include <cstddef>

#include "host_sim/campaign/campaign_file.h"

namespace vbar::campaign {

/// One sentence; `met`: whether the bound reaches the required pass rate. Cases that failed count as not passed.
struct RequirementVerdict {
  bool met = false;
  std::string sentence;
};
[[nodiscard]] RequirementVerdict judge(const Requirement& requirement, std::size_t passed, std::size_t cases,
                                       bool independent);

}  // namespace vbar::campaign
