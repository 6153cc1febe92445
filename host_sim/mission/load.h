#pragma once
// From a mission file to a checked mission.

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "host_sim/mission/mission.h"
#include "host_sim/mission/mission_error.h"

namespace vbar::mission {

/// Reads `file`, puts the overrides ("path=value", overrides.h) over it in order, checks everything. Throws
/// MissionError.
Mission load_mission(const std::filesystem::path& file, std::span<const std::string> overrides = {});

/// As load_mission, for a text already in memory; `file` is what messages call it and what relative paths in it start
/// from.
Mission parse_mission(std::string_view text, const std::filesystem::path& file,
                      std::span<const std::string> overrides = {});

}  // namespace vbar::mission
