#pragma once
// Keys that name a data file.

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "host_sim/mission/mission.h"
#include "host_sim/mission/table_reader.h"

namespace vbar::mission {

// Location of the project's data files.

/// Returns $VBAR_DATA if set, else the data folder of the source tree this program was built from. Throws
/// std::runtime_error that names the folder if it does not exist.
std::filesystem::path data_directory();

/// Returns a file of the data folder or, if it begins with "./" or "../", relative to the mission file; an absolute
/// path stays as it is, and so does one of the `words`, which name no file. On the command line (--set) a relative path
/// is one from the working directory, if that has such a file. Throws MissionError for an empty text.
[[nodiscard]] std::filesystem::path data_file(const TableReader& section, std::string_view key,
                                              const std::filesystem::path& default_value, const Mission& mission,
                                              std::span<const std::string_view> words = {});

/// Reads an array of files as data_file() reads one; the result is empty if the key is missing.
[[nodiscard]] std::vector<std::filesystem::path> data_files(const TableReader& section, std::string_view key,
                                                            const Mission& mission);

/// Returns whether a text is a path relative to the file that states it.
[[nodiscard]] bool is_seen_from_file(std::string_view text);

/// Returns the file of this name in the working directory, absolute, for a key that was set on the command line; empty
/// where there is none.
[[nodiscard]] std::filesystem::path file_on_command_line(const TableReader& section, std::string_view key,
                                                         const std::string& text);

/// Throws MissionError for the first data file that the mission names and that cannot be opened, with the reason and
/// the places that are searched.
void check_data_files(const Mission& mission, const std::filesystem::path& data_directory);

/// Returns the overrides with absolute paths in place of paths from the working directory, so that a repetition of the
/// run finds the same files.
[[nodiscard]] std::vector<std::string> with_absolute_files(std::vector<std::string> overrides, const Mission& mission);

}  // namespace vbar::mission
