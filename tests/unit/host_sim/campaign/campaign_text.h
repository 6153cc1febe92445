#pragma once
// Campaign files for tests.

#include <algorithm>
#include <string>

#include "host_sim/campaign/campaign_file.h"
#include "host_sim/campaign/case.h"

namespace vbar::campaign::test {

inline CampaignFile campaign_of(const std::string& general, const std::string& rest = "") {
  return parse_campaign("[campaign]\nmission = \"experiment3\"\n" + general + "\n" + rest, "test.toml");
}

/// Value of `key` in the case of that seed whose swept values are `swept`.
inline std::string value_of(const CampaignFile& campaign, std::uint64_t seed, const std::vector<std::string>& swept,
                            const std::string& key) {
  const std::vector<std::string> keys = campaign.keys();
  for (const Case& one : expand(campaign)) {
    if (one.seed != seed || !std::equal(swept.begin(), swept.end(), one.values.begin())) continue;
    for (std::size_t k = 0; k < keys.size(); ++k)
      if (keys[k] == key) return one.values[k];
  }
  return "no such case";
}

}  // namespace vbar::campaign::test
