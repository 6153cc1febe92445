#pragma once
// The provenance of a run by this program: what is written at its start and its end, and what a replay finds changed.

#include <string>
#include <vector>

#include "host_sim/mission/mission.h"
#include "host_sim/report/provenance.h"

namespace vbar::app {

/// Returns the provenance at the start, with mission.toml not yet written.
[[nodiscard]] report::Provenance provenance_of(const mission::Mission& mission,
                                               const std::vector<std::string>& overrides,
                                               const std::string& mission_text);

/// The data files that this process has read so far.
[[nodiscard]] std::vector<report::FileDigest> data_read();

/// A sentence for each part of `then` that is another now: program, flight software, mission copy, data files.
[[nodiscard]] std::vector<std::string> changes_since(const report::Provenance& then,
                                                     const std::filesystem::path& mission_copy,
                                                     const std::string& flight_software_now);

}  // namespace vbar::app
