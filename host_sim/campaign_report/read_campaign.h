#pragma once
// Reads what the page is made of.

#include <filesystem>

#include "host_sim/campaign_report/campaign.h"

namespace vbar::campaign_report {

/// Reads campaign.json and results.csv. Throws std::runtime_error that names file, line, column or key and the accepted
/// values: for a missing file, column or case, a case that occurs twice, a number that is not finite, and a case whose
/// result contradicts the limits.
[[nodiscard]] Campaign read_campaign(const std::filesystem::path& folder);

/// The parts of it.
[[nodiscard]] Campaign read_campaign_json(const std::filesystem::path& file, std::size_t& number_of_cases);
void read_results(const std::filesystem::path& file, std::size_t number_of_cases, Campaign& campaign);

}  // namespace vbar::campaign_report
