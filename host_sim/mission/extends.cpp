#include "host_sim/mission/extends.h"

#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

#include "host_sim/mission/alternatives.h"
#include "host_sim/mission/catalogue.h"
#include "host_sim/mission/mission_error.h"
#include "host_sim/mission/nearest_name.h"
#include "host_sim/mission/table_reader.h"
#include "host_sim/mission/toml_file.h"

namespace vbar::mission {
namespace {

constexpr int kLongestChain = 4;

void put_over(toml::table& base, toml::table& own);

/// The key that identifies the elements of an array of tables; empty for other arrays.
std::string_view label_key(std::string_view array) {
  if (array == "spacecraft") return "name";
  return array == "waypoint" ? "index" : "";
}

toml::table* same_element(toml::array& elements, const toml::table& wanted, std::string_view key) {
  const toml::node* const label = wanted.get(key);
  for (toml::node& element : elements) {
    toml::table* const table = element.as_table();
    const toml::node* const other = table == nullptr ? nullptr : table->get(key);
    if (label == nullptr || other == nullptr) continue;
    const auto text = label->value<std::string_view>(), other_text = other->value<std::string_view>();
    if (text ? text == other_text : label->value<std::int64_t>() == other->value<std::int64_t>()) return table;
  }
  return nullptr;
}

void put_elements_over(toml::array& base, toml::array& own, std::string_view key) {
  for (toml::node& element : own) {
    toml::table* const table = element.as_table();
    toml::table* const old = table == nullptr ? nullptr : same_element(base, *table, key);
    if (old != nullptr) {
      put_over(*old, *table);
    } else {
      // Moved, not copied: a copy loses its source location.
      element.visit([&](auto&& value) { base.push_back(std::forward<decltype(value)>(value)); });
    }
  }
}

void put_over(toml::table& base, toml::table& own) {
  for (const auto& [key, value] : own) drop_alternatives(base, key.str());
  for (auto&& [key, value] : own) {
    toml::node* const old = base.get(key.str());
    const std::string_view label = label_key(key.str());
    if (old != nullptr && old->is_table() && value.is_table()) {
      put_over(*old->as_table(), *value.as_table());
    } else if (old != nullptr && old->is_array() && value.is_array() && !label.empty()) {
      put_elements_over(*old->as_array(), *value.as_array(), label);
    } else {
      value.visit([&, &name = key](auto&& some) { base.insert_or_assign(name, std::move(some)); });
    }
  }
}

/// The file of a name in `extends`: seen from the file that extends, or a mission of the catalogue.
std::filesystem::path extended_file(const TableReader& reader, const std::filesystem::path& file,
                                    const std::string& name) {
  std::error_code error;
  std::filesystem::path beside = file.parent_path() / name;
  if (std::filesystem::exists(beside, error)) return beside;
  std::vector<std::filesystem::path> bundled;
  try {
    bundled = mission_files(missions_directory());
  } catch (const std::exception&) {  // without a catalogue only a file is possible
  }
  std::vector<std::string> names;
  for (std::filesystem::path& other : bundled) {
    names.push_back(other.stem().string());
    if (names.back() == name) return std::move(other);
  }
  reader.refuse("extends",
                "\"" + name + "\", which is neither a file nor a mission" +
                    did_you_mean(std::filesystem::path(name).stem().string(), {names.begin(), names.end()}),
                "a mission file, seen from this one, or a name that vbar missions lists");
}

/// A mission that extends another has a name of its own.
void drop_name(toml::table& document) {
  if (toml::table* const general = document["mission"].as_table()) general->erase("name");
}

void resolve(toml::table& document, const std::filesystem::path& file, int depth) {
  const TableReader reader(document, file.string());
  if (!reader.has("extends")) return;
  if (depth == kLongestChain) reader.refuse_value("extends", "a chain of at most four files");
  const std::vector<std::string> names =
      reader.is_array("extends") ? reader.texts("extends") : std::vector<std::string>{reader.text("extends")};
  if (names.empty()) reader.refuse("extends", "no file", "a mission file, or an array of them");
  toml::table base;
  for (const std::string& name : names) {
    const std::filesystem::path other = extended_file(reader, file, name);
    toml::table one = parse_toml(read_text_file(other, "a mission file (TOML)"), other.string());
    resolve(one, other, depth + 1);
    put_over(base, one);
  }
  drop_name(base);
  document.erase("extends");
  put_over(base, document);
  document = std::move(base);
}

}  // namespace

std::string name_of_file(const std::filesystem::path& file) {
  constexpr std::size_t kLongest = 64;
  std::string name = file.stem().string().substr(0, kLongest);
  for (char& letter : name)
    if (!is_name({&letter, 1})) letter = '_';
  return name;
}

void put_over_extended(toml::table& document, const std::filesystem::path& file) {
  resolve(document, file, 0);
}

std::string whole_mission_text(const std::filesystem::path& file) {
  std::string own = read_text_file(file, "a mission file (TOML)");
  toml::table document = parse_toml(own, file.string());
  if (!document.contains("extends")) return own;
  put_over_extended(document, file);
  // The text may be kept under another name.
  if (toml::table* const general = document["mission"].as_table(); general != nullptr && !general->contains("name"))
    general->insert("name", name_of_file(file));
  std::ostringstream text;
  text << document << '\n';
  return text.str();
}

}  // namespace vbar::mission
