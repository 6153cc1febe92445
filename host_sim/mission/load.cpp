#include "host_sim/mission/load.h"

#include <algorithm>
#include <iomanip>
#include <iterator>
#include <map>
#include <optional>
#include <sstream>
#include <string_view>

#include "host_sim/files/data_stream.h"
#include "host_sim/mission/data_file.h"
#include "host_sim/mission/mission_document.h"
#include "host_sim/mission/name_search.h"
#include "host_sim/mission/read_sections.h"
#include "host_sim/mission/toml_file.h"

namespace vbar::mission {

namespace {

/// A table or an array of tables of the document.
struct Section {
  const char* name;
  void (*read)(const TableReader& document, Mission& mission, const Installation& installation);
};

template <auto read>
void without_installation(const TableReader& document, Mission& mission, const Installation& /*installation*/) {
  read(document, mission);
}

/// In the order of reading, because later ones depend on the results of earlier ones.
constexpr Section kSections[] = {{"mission", without_installation<read_general>},
                                 {"truth", read_truth},
                                 {"testbed", read_testbeds},
                                 {"waypoint", without_installation<read_waypoints>},
                                 {"spacecraft", read_spacecraft},
                                 {"guidance", without_installation<read_guidance>},
                                 {"safety", without_installation<read_safety>},
                                 {"navigation", read_shared},
                                 {"burn", without_installation<read_burns>},
                                 {"fault", without_installation<read_faults>},
                                 {"clock", read_clock},
                                 {"links", without_installation<read_links>},
                                 {"lcm", without_installation<read_lcm>},
                                 {"telemetry", without_installation<read_telemetry>},
                                 {"record", without_installation<read_record>},
                                 {"limit", without_installation<read_limits>}};

template <class Use>
void with_document(std::string_view text, const std::filesystem::path& file, std::span<const std::string> overrides,
                   const Installation& installation, const Use& use) {
  toml::table table = parse_toml(text, file.string());
  put_over_extended(table, file);
  for (const std::string& assignment : overrides) apply_override(table, assignment);

  const TableReader document(table, file.string());
  for (const Section& section : kSections) static_cast<void>(document.has(section.name));
  for (const SensorReader* const kind : installation.kinds)
    if (!kind->table.empty()) static_cast<void>(document.has(kind->table));
  if (document.has("extends")) document.refuse_value("extends", "nothing here: it is resolved before any --set");
  document.refuse_unknown_keys();
  Mission mission;
  mission.file = file;
  for (const Section& section : kSections) section.read(document, mission, installation);
  place_rtn_waypoints(document, mission);
  check_testbeds(document, mission, installation);
  document.finish();
  mission.data_files = document.data_files();
  use(document, std::move(mission));
}

}  // namespace

Mission parse_mission(std::string_view text, const std::filesystem::path& file, std::span<const std::string> overrides,
                      const Installation& installation) {
  Mission loaded;
  with_document(text, file, overrides, installation,
                [&](const TableReader& /*document*/, Mission mission) { loaded = std::move(mission); });
  return loaded;
}

Mission load_mission(const std::filesystem::path& file, std::span<const std::string> overrides,
                     const Installation& installation) {
  return parse_mission(read_text_file(file, "a mission file (TOML)"), file, overrides, installation);
}

std::map<std::string, std::vector<AcceptedKey>> accepted_keys(const std::filesystem::path& file,
                                                              std::span<const std::string> overrides,
                                                              const Installation& installation) {
  std::map<std::string, std::vector<AcceptedKey>> keys;
  with_document(read_text_file(file, "a mission file (TOML)"), file, overrides, installation,
                [&](const TableReader& document, const Mission& /*mission*/) { keys = document.asked_of_all(); });
  return keys;
}

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

namespace {

constexpr std::string_view kNamed = "spacecraft.";  // whose elements have names in a reader's path

bool is_number(std::string_view text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
}

constexpr const char* kMeanings = "mission_keys.toml";  // name of the file in the data folder

/// The meaning of a key in the file of meanings, whose tables are those of a mission.
std::string meaning_of(const toml::table& meanings, const std::string& table, const std::string& key) {
  const toml::node_view<const toml::node> root(meanings);
  const auto section = table.empty() ? root : meanings.at_path(table);
  return section[key].value_or(std::string());
}

using Tables = std::map<std::string, std::vector<AcceptedKey>>;

/// Removes a sensor that has the same keys as one before it by name: two sensors of one kind, whose twin has one name,
/// are listed once.
void list_each_kind_once(Tables& tables) {
  constexpr std::string_view kSensors = "spacecraft.sensors.";
  const auto inside = [&](const std::string& table) {
    const std::size_t end = table.find('.', kSensors.size());
    return end == std::string::npos ? std::string() : table.substr(end);
  };
  const auto has_all = [](const std::vector<AcceptedKey>& keys, const std::vector<AcceptedKey>& others) {
    return std::ranges::all_of(others, [&](const AcceptedKey& key) {
      const auto known = std::ranges::find(keys, key.name, &AcceptedKey::name);
      return known != keys.end() && (key.name != "source" || known->default_value == key.default_value);
    });
  };
  for (auto first = tables.begin(); first != tables.end(); ++first) {
    if (!first->first.starts_with(kSensors)) continue;
    for (auto other = std::next(first); other != tables.end();) {
      const bool is_repeated = other->first.starts_with(kSensors) && inside(other->first) == inside(first->first) &&
                               has_all(first->second, other->second);
      other = is_repeated ? tables.erase(other) : std::next(other);
    }
  }
}

}  // namespace

std::string table_of_path(const std::string& path) {
  std::string table;
  std::istringstream parts(path);
  int place = 0;
  for (std::string part; std::getline(parts, part, '.'); ++place) {
    const bool is_name = place == 1 && path.starts_with(kNamed);
    if (is_name || is_number(part)) continue;
    if (!table.empty()) table += '.';
    table += part;
  }
  return table;
}

std::vector<DescribedKey> key_reference(const std::filesystem::path& folder, const Installation& installation) {
  Tables tables;
  const std::filesystem::path file = installation.data_directory / kMeanings;
  const toml::table meanings = parse_toml(read_text_file(file, "the meanings of keys (TOML)"), file.string());
  for (const CatalogueEntry& entry : list_missions(folder, installation)) {
    for (const auto& [path, keys] : accepted_keys(entry.file, {}, installation)) {
      std::vector<AcceptedKey>& known = tables[table_of_path(path)];
      for (const AcceptedKey& key : keys) {
        const auto place = std::ranges::find(known, key.name, &AcceptedKey::name);
        if (place == known.end()) {
          known.push_back(key);
        } else if (place->accepted.empty()) {
          *place = key;  // a mission read its value, not only whether it is there
        }
      }
    }
  }
  list_each_kind_once(tables);
  std::vector<DescribedKey> all;
  for (const auto& [table, keys] : tables)
    for (const AcceptedKey& key : keys) all.push_back({table, key, meaning_of(meanings, table, key.name)});
  return all;
}

}  // namespace vbar::mission
