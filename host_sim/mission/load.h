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
#include "host_sim/mission/table_reader.h"

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

// The catalogue: the mission files of a folder.

struct CatalogueEntry {
  std::filesystem::path file;
  std::string name;         ///< the file's stem if the file is invalid
  std::string description;  ///< or the error message if the file is invalid
  double duration_h = 0.0;
  bool good = false;
};

/// Returns every *.toml file of `folder`, in order of file name. Throws MissionError if there is no such folder.
[[nodiscard]] std::vector<std::filesystem::path> mission_files(const std::filesystem::path& folder);

/// Loads a mission file as an entry of the catalogue.
[[nodiscard]] CatalogueEntry entry_of(const std::filesystem::path& file, const Installation& installation);

/// Returns the files of a folder, loaded.
[[nodiscard]] std::vector<CatalogueEntry> list_missions(const std::filesystem::path& folder,
                                                        const Installation& installation);

/// Returns the folder of the mission files: `missions` here, or the one next to the data directory. Throws
/// MissionError.
[[nodiscard]] std::filesystem::path missions_directory();

/// Returns the mission file of a path or a name of the catalogue. Throws MissionError that names the nearest mission.
[[nodiscard]] std::filesystem::path find_mission(const std::filesystem::path& path_or_name,
                                                 const Installation& installation);

/// Returns one line of the catalogue, without a line end: name, duration in hours, description; names padded to
/// `name_width`.
[[nodiscard]] std::string line_of(const CatalogueEntry& entry, std::size_t name_width);

// The reference of mission files: every key that readers accept, from the readers themselves; its meaning, from the
// file of meanings.

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
