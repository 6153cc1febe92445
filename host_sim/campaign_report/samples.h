#pragma once
// Figures at selected times: "samples.39.5h.nees" is the NEES 39.5 h after the epoch.

#include <string_view>
#include <vector>

#include "host_sim/campaign_report/campaign.h"
#include "host_sim/campaign_report/ensemble_consistency.h"

namespace vbar::campaign_report {

/// Epochs of `name` ("nees" or "nis") in order of time, over the complete cases among `places` that have it. Throws
/// std::runtime_error that names the column, for a negative value and one without its dimension.
[[nodiscard]] std::vector<Epoch> epochs_of(const Campaign& campaign, std::string_view name,
                                           const std::vector<std::size_t>& places);

/// Times of the campaign of which results.csv has no such column, although cases are complete.
[[nodiscard]] std::vector<double> missing_samples(const Campaign& campaign);

}  // namespace vbar::campaign_report
