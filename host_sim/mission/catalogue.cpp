#include "host_sim/mission/catalogue.h"

#include <algorithm>
#include <iomanip>
#include <optional>
#include <sstream>

#include "host_sim/files/data_stream.h"
#include "host_sim/mission/data_directory.h"
#include "host_sim/mission/load.h"
#include "host_sim/mission/nearest_name.h"

namespace vbar::mission {

CatalogueEntry entry_of(const std::filesystem::path& file, const Installation& installation) {
  const files::UnrecordedReads looked_at;
  CatalogueEntry entry;
  entry.file = file;
  try {
    const Mission mission = load_mission(file, {}, installation);
    entry.name = mission.name;
    entry.description = mission.description;
    entry.duration_h = fsw::seconds(mission.duration) / 3600.0;
    entry.good = true;
  } catch (const MissionError& error) {
    entry.name = file.stem().string();
    entry.description = error.what();
  }
  return entry;
}

namespace {

/// The file NAME.toml, if the mission in it has that name: the others need not be loaded.
std::optional<std::filesystem::path> file_of_that_name(const std::filesystem::path& name,
                                                       const Installation& installation) {
  if (name.has_parent_path()) return std::nullopt;
  try {
    const std::filesystem::path file = missions_directory() / (name.string() + ".toml");
    std::error_code error;
    if (std::filesystem::is_regular_file(file, error) && entry_of(file, installation).name == name) return file;
  } catch (const std::exception&) {  // no catalogue
  }
  return std::nullopt;
}

}  // namespace

std::vector<std::filesystem::path> mission_files(const std::filesystem::path& folder) {
  std::error_code error;
  std::vector<std::filesystem::path> files;
  for (std::filesystem::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    if (it->path().extension() == ".toml") files.push_back(it->path());
  if (error) throw MissionError(folder.string(), "", "no folder that can be read", "a folder of mission files");
  std::sort(files.begin(), files.end());
  return files;
}

std::vector<CatalogueEntry> list_missions(const std::filesystem::path& folder, const Installation& installation) {
  std::vector<CatalogueEntry> entries;
  for (const auto& file : mission_files(folder)) entries.push_back(entry_of(file, installation));
  return entries;
}

std::filesystem::path missions_directory() {
  const std::filesystem::path here = "missions";
  if (std::filesystem::is_directory(here)) return here;
  return data_directory().parent_path() / "missions";
}

std::filesystem::path find_mission(const std::filesystem::path& path_or_name, const Installation& installation) {
  std::error_code error;
  if (std::filesystem::is_regular_file(path_or_name, error)) return path_or_name;
  if (const auto file = file_of_that_name(path_or_name, installation)) return *file;
  std::vector<CatalogueEntry> missions;
  try {
    missions = list_missions(missions_directory(), installation);
  } catch (const std::exception&) {  // no catalogue: then only a path is possible
  }
  std::vector<std::string_view> names;
  for (const CatalogueEntry& entry : missions) {
    if (path_or_name == entry.name) return entry.file;
    names.push_back(entry.name);
  }
  const std::string wanted = path_or_name.stem().string();
  const auto nearest = nearest_name(wanted, names);
  throw MissionError(
      path_or_name.string(), "",
      std::filesystem::exists(path_or_name, error) ? "something that is not a file" : "no such file or mission",
      "a mission file (TOML) or a name that vbar missions lists" +
          (nearest ? "; did you mean " + std::string(*nearest) + "?" : std::string()));
}

std::string line_of(const CatalogueEntry& entry, std::size_t name_width) {
  std::ostringstream line;
  line << std::left << std::setw(static_cast<int>(name_width)) << entry.name << "  ";
  if (entry.good)
    line << std::right << std::fixed << std::setprecision(2) << std::setw(7) << entry.duration_h << " h  ";
  else
    line << "cannot be run: ";
  line << entry.description;
  return line.str();
}

}  // namespace vbar::mission
