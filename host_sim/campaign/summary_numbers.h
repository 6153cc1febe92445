#pragma once
// The numbers of a summary.json by dotted keys: what criteria of a campaign name and results.csv holds.

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host_sim/campaign/record_file.h"

namespace vbar::campaign {

/// Numbers in the order of the file, without those that are null. Elements of arrays stand by what identifies them:
/// waypoints.10.navigation_error_m, samples.39.5h.nees, sources.servicer/gnss.epochs. Means and deviations have their
/// unit last: navigation_error_mean_m. Wall-clock times and the provenance are left out.
using Numbers = std::vector<std::pair<std::string, double>>;

[[nodiscard]] Numbers numbers_of(const Json& summary);

/// SHA-256 of what the summary says of the waypoints.
[[nodiscard]] std::string waypoints_sha256(const Json& summary);

[[nodiscard]] std::optional<double> find_number(const Numbers& numbers, const std::string& key);

}  // namespace vbar::campaign
