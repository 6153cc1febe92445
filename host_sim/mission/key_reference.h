#pragma once
// The reference of mission files: every key that readers accept, from the readers themselves; its meaning, from the
// file of meanings.

#include <filesystem>
#include <string>
#include <vector>

#include "host_sim/mission/sensor_reader.h"
#include "host_sim/mission/table_reader.h"

namespace vbar::mission {

struct DescribedKey {
  std::string table;  ///< as in a header of a file: "spacecraft.sensors.camera"; empty at the top
  AcceptedKey key;
  std::string meaning;  ///< in data/mission_keys.toml; empty: it has none there
};

/// Returns the keys of all missions in `folder`, in the order of tables, and within a table in the order of reading. A
/// key is listed if a mission's reader asks for it. Throws MissionError if a mission, or the file of meanings, is
/// invalid.
[[nodiscard]] std::vector<DescribedKey> key_reference(const std::filesystem::path& folder,
                                                      const Installation& installation);

/// Returns the path of a reader's table without names and numbers of elements: "spacecraft.servicer.sensors.camera" and
/// "waypoint.3" are "spacecraft.sensors.camera" and "waypoint".
[[nodiscard]] std::string table_of_path(const std::string& path);

}  // namespace vbar::mission
