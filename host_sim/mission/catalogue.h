#pragma once
// The catalogue: the mission files of a folder.

#include <filesystem>
#include <string>
#include <vector>

#include "host_sim/mission/sensor_reader.h"

namespace vbar::mission {

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

}  // namespace vbar::mission
