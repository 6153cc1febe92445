#include "host_sim/report/navigation_errors.h"

#include <algorithm>
#include <map>

namespace vbar::report {
namespace {

constexpr int kGnssFixed = telemetry_navigation::kSourceGnssFixed;

}  // namespace

std::vector<NavigationError> navigation_errors(const RunRecord& record) {
  std::map<double, const TruthRow*> truth_at;
  for (const TruthRow& row : record.truth) truth_at[row.time_s] = &row;
  std::vector<NavigationError> all;
  for (const EstimateRow& row : record.estimates) {
    const auto truth = truth_at.find(row.time_s);
    if (row.navigation_valid == 0 || truth == truth_at.end()) continue;
    NavigationError& error = all.emplace_back();
    error.time_s = row.time_s;
    error.sigma_rtn = row.sigma_rtn;
    for (std::size_t k = 0; k < 3; ++k) {
      error.position_rtn[k] = row.relative_position_rtn[k] - truth->second->relative_position_rtn[k];
      error.velocity_rtn[k] = row.relative_velocity_rtn[k] - truth->second->relative_velocity_rtn[k];
    }
  }
  return all;
}

std::optional<double> first_fix(const RunRecord& record) {
  const auto found = std::ranges::find_if(record.estimates, [](const EstimateRow& row) {
    return row.navigation_valid != 0 && row.navigation_source == kGnssFixed;
  });
  if (found == record.estimates.end()) return std::nullopt;
  return found->time_s;
}

}  // namespace vbar::report
