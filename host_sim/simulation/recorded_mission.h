#pragma once
// The recorded mission of a run folder. A folder may come from anywhere: what it names is neither loaded nor
// opened unless the user names or trusts it.

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "host_sim/mission/mission.h"
#include "host_sim/report/summary.h"

namespace vbar::app {

/// Files of a run folder: the mission file, and the overrides with which it was flown, one a line.
inline constexpr const char* kMissionCopy = "mission.toml";
inline constexpr const char* kOverridesCopy = "overrides.txt";

/// File in the folder of a branch: where it left another run.
inline constexpr const char* kBranchCopy = "branch.txt";

/// "library" of "flight_computer.library=x" or "spacecraft.servicer.flight_computer.library=x"; empty for another key.
[[nodiscard]] std::string_view flight_computer_key(std::string_view assignment);

/// "path=value", in the order in which they were given.
[[nodiscard]] std::vector<std::string> overrides_of_run(const std::filesystem::path& run_folder);

/// Throws Refused for a mission without a flight computer and, unless the folder is trusted, for a library, image,
/// device or address of the flight computer that is not among the overrides `given` now.
void check_trust(const mission::Mission& mission, const std::filesystem::path& run_folder,
                 std::span<const std::string> given, bool is_trusted);

/// Throws Refused, which names the file.
[[nodiscard]] report::Summary summary_of_run(const std::filesystem::path& run_folder);

}  // namespace vbar::app
