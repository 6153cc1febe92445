#pragma once
// Keys that name a data file.

#include <filesystem>
#include <string_view>
#include <vector>

#include "host_sim/mission/mission.h"
#include "host_sim/mission/table_reader.h"

namespace vbar::mission {

/// A file of the data folder, or, if it begins with "./" or "../", relative to the mission file; an absolute path and a
/// word such as "bundled" stay as they are. Throws MissionError for an empty text.
[[nodiscard]] std::filesystem::path data_file(const TableReader& section, std::string_view key,
                                              const std::filesystem::path& default_value, const Mission& mission);

/// The same of an array of files; empty if the key is missing.
[[nodiscard]] std::vector<std::filesystem::path> data_files(const TableReader& section, std::string_view key,
                                                            const Mission& mission);

}  // namespace vbar::mission
