#include "host_sim/mission/mission_document.h"

#include <algorithm>
#include <array>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

#include "host_sim/mission/load.h"
#include "host_sim/mission/mission_error.h"
#include "host_sim/mission/name_search.h"
#include "host_sim/mission/table_reader.h"
#include "host_sim/mission/toml_file.h"

namespace vbar::mission {

namespace {

struct Replacement {
  std::string_view key;
  std::array<std::string_view, 3> replaced;
};
constexpr std::array<Replacement, 8> kReplacements{{{"elements", {"relative", "orbit_file", "orbit_object"}},
                                                    {"relative", {"elements", "orbit_file", "orbit_object"}},
                                                    {"orbit_file", {"elements", "relative"}},
                                                    {"waypoint", {"a_roe_m"}},
                                                    {"a_roe_m", {"waypoint", "position_rtn_m", "velocity_rtn_mps"}},
                                                    {"position_rtn_m", {"a_roe_m"}},
                                                    {"focal_length_mm", {"field_of_view_deg"}},
                                                    {"field_of_view_deg", {"focal_length_mm"}}}};

}  // namespace

void drop_alternatives(toml::table& table, std::string_view key) {
  for (const Replacement& replacement : kReplacements) {
    if (replacement.key != key) continue;
    for (const std::string_view other : replacement.replaced)
      if (!other.empty()) table.erase(other);
  }
}

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

namespace {

constexpr const char* kAssignment = "path=value with a dotted path, e.g. mission.seed=3";

// Arrays of tables whose elements are addressed by the value of a key. Vehicles are those of a scenario file of the
// emulated GNSS testbed.
struct LabelledArray {
  std::string_view name;
  const char* label;
};
constexpr std::array<LabelledArray, 4> kLabelledArrays{
    {{"spacecraft", "name"}, {"waypoint", "index"}, {"fault", "name"}, {"vehicle", "name"}}};

struct Override {
  std::string where;  // "--set path=value"
  std::string path;   // as given
  std::string value;

  [[noreturn]] void refuse(const std::string& found, const std::string& accepted) const {
    throw MissionError(where, path, found, accepted);
  }
};

std::vector<std::string> split(const std::string& path) {
  std::vector<std::string> segments(1);
  for (const char c : path) {
    if (c == '.')
      segments.emplace_back();
    else
      segments.back() += c;
  }
  return segments;
}

std::string label_of(const toml::table& element, const std::string& key) {
  const toml::node* node = element.get(key);
  if (node == nullptr) return {};
  if (const auto* text = node->as_string()) return text->get();
  if (const auto* integer = node->as_integer()) return std::to_string(integer->get());
  return {};
}

/// A path without a spacecraft that begins with flight_computer or the name of a sensor of the servicer.
std::vector<std::string> with_servicer(toml::table& document, std::vector<std::string> segments) {
  const bool is_computer = segments.front() == "flight_computer";
  bool is_sensor = false;
  if (const toml::array* const all = document["spacecraft"].as_array();
      all != nullptr && !document.contains(segments.front()))
    for (const toml::node& element : *all)
      if (const toml::table* const table = element.as_table();
          table != nullptr && label_of(*table, "name") == "servicer")
        is_sensor = (*table)["sensors"][segments.front()].is_table();
  if (!is_sensor && !is_computer) return segments;
  std::vector<std::string> prefix{"spacecraft", "servicer"};
  if (is_sensor) prefix.emplace_back("sensors");
  segments.insert(segments.begin(), prefix.begin(), prefix.end());
  return segments;
}

// The element of array-of-tables `array` whose `key` is `label`.
toml::table& element_by_label(toml::table& document, const Override& set, const std::string& array,
                              const std::string& key, const std::string& label) {
  std::vector<std::string> labels;
  if (toml::array* elements = document[array].as_array()) {
    for (toml::node& element : *elements) {
      toml::table* table = element.as_table();
      if (table == nullptr) continue;
      labels.push_back(label_of(*table, key));
      if (labels.back() == label) return *table;
    }
  }
  const std::string accepted = listing_of(std::vector<std::string_view>(labels.begin(), labels.end()));
  set.refuse("no " + array + " whose " + key + " is \"" + label + "\"",
             labels.empty() ? "nothing, the mission file has no " + array : array + "." + accepted);
}

toml::table parse_value(const Override& set) {
  if (line_too_deep("value = " + set.value))
    set.refuse("a value nested deeper than " + std::to_string(kTomlDepthMax) + " levels", "a value of fewer levels");
  try {
    toml::table parsed = toml::parse("value = " + set.value, set.where);
    if (parsed.size() == 1) return parsed;
  } catch (const toml::parse_error&) {  // a text without quotes
  }
  std::string quoted;
  for (const char c : set.value) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  try {
    return toml::parse("value = \"" + quoted + "\"", set.where);
  } catch (const toml::parse_error& error) {
    set.refuse("an invalid TOML value (" + std::string(error.description()) + ")", "a TOML value or plain text");
  }
}

Override parse_assignment(const std::string& assignment) {
  const std::size_t equals = assignment.find('=');
  Override set{"--set " + assignment, assignment.substr(0, equals), ""};
  if (equals == std::string::npos) set.refuse("no '='", kAssignment);
  set.value = assignment.substr(equals + 1);
  if (line_too_deep(set.path + " = 0"))
    set.refuse("more than " + std::to_string(kTomlDepthMax) + " names in the path", kAssignment);
  for (const std::string& segment : split(set.path))
    if (segment.empty()) set.refuse("an empty name in the path", kAssignment);
  return set;
}

/// Replaces a labelled element by a table, which keeps the label unless it states one.
void replace_element(toml::table& element, const std::string& label, const Override& set) {
  toml::table parsed = parse_value(set);
  toml::table* const whole = parsed["value"].as_table();
  if (whole == nullptr)
    set.refuse("a path that ends too early",
               "spacecraft.NAME.KEY=value or waypoint.INDEX.KEY=value, or a table as value");
  element.get(label)->visit([&](const auto& kept) { whole->insert(label, kept); });
  element = std::move(*whole);
}

}  // namespace

void apply_override(toml::table& document, const std::string& assignment) {
  const Override set = parse_assignment(assignment);
  const std::vector<std::string> path = with_servicer(document, split(set.path));

  toml::table* table = &document;
  std::size_t next = 0;
  const auto* const labelled = std::ranges::find(kLabelledArrays, path.front(), &LabelledArray::name);
  if (labelled != kLabelledArrays.end() && path.size() > 1) {
    table = &element_by_label(document, set, path[0], labelled->label, path[1]);
    if (path.size() == 2) return replace_element(*table, std::string(labelled->label), set);
    next = 2;
  }
  for (; next + 1 < path.size(); ++next) {
    toml::node* inner = table->get(path[next]);
    if (inner == nullptr) inner = &table->insert_or_assign(path[next], toml::table{}).first->second;
    if (!inner->is_table())
      set.refuse("a path through " + path[next] + ", which is " + description_of(*inner), "a path through tables");
    table = inner->as_table();
  }
  toml::table parsed = parse_value(set);
  drop_alternatives(*table, path.back());
  // Moved, not copied: a copy loses its source location.
  parsed.get("value")->visit([&](auto&& value) { table->insert_or_assign(path.back(), std::move(value)); });
}

}  // namespace vbar::mission
