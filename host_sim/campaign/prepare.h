#pragma once
// Makes the folder of a campaign from a campaign file. Every case is loaded first: a campaign of which one case is
// rejected does not start.

#include <filesystem>
#include <string>

#include "host_sim/campaign/folder.h"
#include "host_sim/campaign/plan.h"

namespace vbar::campaign {

/// Makes `folder`, with a line of progress on a terminal unless `quiet`. Throws app::Refused that names the case, the
/// key and what is accepted, or that the folder is in use; then nothing was made. Throws std::runtime_error if a file
/// cannot be written or copied.
void prepare(const CampaignFile& campaign, const Folder& folder, const std::string& vbar_version, bool quiet);

/// Whether the folder holds the campaign of this file.
[[nodiscard]] bool holds_same_campaign(const Folder& folder, const std::filesystem::path& file);

}  // namespace vbar::campaign
