#include "host_sim/mission/extends.h"

#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

#include "host_sim/mission/alternatives.h"
#include "host_sim/mission/mission_error.h"
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

void resolve(toml::table& document, const std::filesystem::path& file, int depth) {
  const TableReader reader(document, file.string());
  if (!reader.has("extends")) return;
  if (depth == kLongestChain) reader.refuse_value("extends", "a chain of at most four files");
  const std::vector<std::string> names =
      reader.is_array("extends") ? reader.texts("extends") : std::vector<std::string>{reader.text("extends")};
  if (names.empty()) reader.refuse("extends", "no file", "a mission file, or an array of them");
  toml::table base;
  for (const std::string& name : names) {
    const std::filesystem::path other = file.parent_path() / name;
    toml::table one = [&] {
      try {
        return parse_toml(read_text_file(other, "a mission file (TOML)"), other.string());
      } catch (const MissionError& error) {
        reader.refuse("extends", std::string("an invalid file: ") + error.what(), "a mission file");
      }
    }();
    resolve(one, other, depth + 1);
    put_over(base, one);
  }
  document.erase("extends");
  put_over(base, document);
  document = std::move(base);
}

}  // namespace

void put_over_extended(toml::table& document, const std::filesystem::path& file) {
  resolve(document, file, 0);
}

std::string whole_mission_text(const std::filesystem::path& file) {
  std::string own = read_text_file(file, "a mission file (TOML)");
  toml::table document = parse_toml(own, file.string());
  if (!document.contains("extends")) return own;
  put_over_extended(document, file);
  std::ostringstream text;
  text << document << '\n';
  return text.str();
}

}  // namespace vbar::mission
