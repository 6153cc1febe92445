#include "host_sim/campaign_report/sweep.h"

#include <algorithm>
#include <map>
#include <set>

#include <fmt/format.h>

namespace vbar::campaign_report {

std::vector<SweepPoint> sweep_points(const Campaign& campaign) {
  std::vector<std::size_t> swept;
  for (const std::string& key : campaign.swept)
    swept.push_back(static_cast<std::size_t>(std::ranges::find(campaign.keys, key) - campaign.keys.begin()));
  std::vector<SweepPoint> points;
  std::map<std::string, std::size_t> known;
  for (std::size_t place = 0; place < campaign.cases.size(); ++place) {
    std::string name;
    for (const std::size_t key : swept)
      name += fmt::format("{}{} = {}", name.empty() ? "" : ", ", campaign.keys[key], campaign.cases[place].inputs[key]);
    const auto [found, is_new] = known.emplace(name, points.size());
    if (is_new) points.push_back({name, {}});
    points[found->second].places.push_back(place);
  }
  return points;
}

bool share_seeds(const Campaign& campaign) {
  if (campaign.swept.empty()) return false;
  std::set<std::string_view> seeds;
  return !std::ranges::all_of(campaign.cases, [&](const Case& one) { return seeds.insert(one.seed).second; });
}

}  // namespace vbar::campaign_report
