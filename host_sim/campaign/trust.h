#pragma once
// Whether the flights of a campaign's folder would execute anything but this program. A folder may come from anywhere,
// and the list of checksums in it with it.

#include "host_sim/campaign/folder.h"
#include "host_sim/campaign/plan.h"

namespace vbar::campaign {

/// Throws app::Refused unless the folder is trusted, or its program, and what stands beside it, is that of this
/// installation, and its mission names no library, image, device, address or testbed.
void check_trust(const Folder& folder, const Plan& plan, const std::vector<Case>& cases, bool is_trusted);

}  // namespace vbar::campaign
