#include "host_sim/mission/key_reference.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <sstream>
#include <string_view>
#include <utility>

#include "host_sim/mission/catalogue.h"
#include "host_sim/mission/load.h"
#include "host_sim/mission/toml_file.h"

namespace vbar::mission {
namespace {

constexpr std::string_view kNamed = "spacecraft.";  // whose elements have names in a reader's path

bool is_number(std::string_view text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
}

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

/// Position of the comment's '#', outside texts.
std::size_t comment_of(std::string_view line) {
  char quote = '\0';
  for (std::size_t k = 0; k < line.size(); ++k) {
    if (quote == '\0' && (line[k] == '"' || line[k] == '\'')) {
      quote = line[k];
    } else if (line[k] == quote) {
      quote = '\0';
    } else if (quote == '\0' && line[k] == '#') {
      return k;
    }
  }
  return std::string_view::npos;
}

using Meanings = std::map<std::pair<std::string, std::string>, std::string>;  // by table and key

/// Adds the comments behind the keys of a file that no file before it had.
void add_meanings(const std::string& file_text, Meanings& meanings) {
  std::istringstream lines(file_text);
  std::string table;
  for (std::string line; std::getline(lines, line);) {
    const std::string_view text = trimmed(line);
    if (text.starts_with('[')) {
      table = std::string(text.substr(0, text.find(']')));
      std::erase(table, '[');
      continue;
    }
    const std::size_t comment = comment_of(text), equals = text.find('=');
    if (comment == std::string_view::npos || equals == std::string_view::npos || equals > comment) continue;
    meanings.try_emplace({table, std::string(trimmed(text.substr(0, equals)))}, trimmed(text.substr(comment + 1)));
  }
}

using Tables = std::map<std::string, std::vector<AcceptedKey>>;

/// Of two sensors of one kind the first one, by name, stands for both: another whose keys it has is taken out.
void list_each_kind_once(Tables& tables) {
  constexpr std::string_view kSensors = "spacecraft.sensors.";
  const auto inside = [&](const std::string& table) {
    const std::size_t end = table.find('.', kSensors.size());
    return end == std::string::npos ? std::string() : table.substr(end);
  };
  const auto has_all = [](const std::vector<AcceptedKey>& keys, const std::vector<AcceptedKey>& others) {
    return std::ranges::all_of(others, [&](const AcceptedKey& key) {
      return std::ranges::find(keys, key.name, &AcceptedKey::name) != keys.end();
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
  Meanings meanings;
  for (const CatalogueEntry& entry : list_missions(folder, installation)) {
    add_meanings(read_text_file(entry.file, "a mission file (TOML)"), meanings);
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
    for (const AcceptedKey& key : keys) {
      const auto meaning = meanings.find({table, key.name});
      all.push_back({table, key, meaning != meanings.end() ? meaning->second : std::string()});
    }
  return all;
}

}  // namespace vbar::mission
