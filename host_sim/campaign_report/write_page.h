#pragma once
// The page of a campaign: one file that opens from disk, without scripts.

#include <filesystem>
#include <string>

#include "host_sim/campaign_report/campaign.h"

namespace vbar::campaign_report {

/// The page. `folder_name` stands in the commands that fly a case again.
[[nodiscard]] std::string page_of(const Campaign& campaign, const std::string& folder_name);

}  // namespace vbar::campaign_report

namespace vbar::campaign {

/// Reads campaign.json and results.csv of the folder, of a campaign that has ended or still runs, and writes
/// campaign.html. The same two files give the same page. Throws std::runtime_error that names what is missing or wrong;
/// a page that was there before then still is. The
/// path of the page.
std::filesystem::path write_page(const std::filesystem::path& folder);

}  // namespace vbar::campaign
