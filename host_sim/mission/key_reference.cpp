#include "host_sim/mission/key_reference.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <sstream>
#include <string_view>

#include "host_sim/mission/catalogue.h"
#include "host_sim/mission/load.h"
#include "host_sim/mission/toml_file.h"

namespace vbar::mission {
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
