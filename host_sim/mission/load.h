#pragma once
// Loads and checks a mission file.

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

/// Reads `file`, applies the overrides ("path=value", mission_document.h) to it in order, checks all. Throws
/// MissionError.
Mission load_mission(const std::filesystem::path& file, std::span<const std::string> overrides,
                     const Installation& installation);

/// Loads a mission as load_mission() does, from a text already in memory. `file` is its name in messages and the base
/// of relative paths in it.
Mission parse_mission(std::string_view text, const std::filesystem::path& file, std::span<const std::string> overrides,
                      const Installation& installation);

/// Returns the keys that the tables of a mission accept, by the dotted path of the table: those that were read when it
/// was loaded. Throws MissionError for a mission that does not load.
std::map<std::string, std::vector<AcceptedKey>> accepted_keys(const std::filesystem::path& file,
                                                              std::span<const std::string> overrides,
                                                              const Installation& installation);

}  // namespace vbar::mission
