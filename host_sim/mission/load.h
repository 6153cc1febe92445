#pragma once
// From a mission file to a checked mission.

#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "host_sim/mission/mission.h"
#include "host_sim/mission/mission_error.h"
#include "host_sim/mission/sensor_reader.h"

namespace vbar::mission {

/// Reads `file`, puts the overrides ("path=value", overrides.h) over it in order, checks everything. Throws
/// MissionError.
Mission load_mission(const std::filesystem::path& file, std::span<const std::string> overrides,
                     const Installation& installation);

/// As load_mission, for a text already in memory; `file` is what messages call it and what relative paths in it start
/// from.
Mission parse_mission(std::string_view text, const std::filesystem::path& file, std::span<const std::string> overrides,
                      const Installation& installation);

/// The keys that the tables of a mission accept, by the dotted path of the table: those that were asked for when it was
/// loaded. Throws MissionError for a mission that does not load.
std::map<std::string, std::vector<std::string>> accepted_keys(const std::filesystem::path& file,
                                                              std::span<const std::string> overrides,
                                                              const Installation& installation);

}  // namespace vbar::mission
