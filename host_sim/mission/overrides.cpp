#include "host_sim/mission/overrides.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

#include "host_sim/mission/alternatives.h"
#include "host_sim/mission/mission_error.h"
#include "host_sim/mission/table_reader.h"
#include "host_sim/mission/toml_depth.h"

namespace vbar::mission {
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

}  // namespace

void apply_override(toml::table& document, const std::string& assignment) {
  const Override set = parse_assignment(assignment);
  const std::vector<std::string> path = with_servicer(document, split(set.path));

  toml::table* table = &document;
  std::size_t next = 0;
  const auto* const labelled = std::ranges::find(kLabelledArrays, path.front(), &LabelledArray::name);
  if (labelled != kLabelledArrays.end() && path.size() > 1) {
    if (path.size() == 2)
      set.refuse("a path that ends too early", "spacecraft.NAME.KEY=value or waypoint.INDEX.KEY=value");
    table = &element_by_label(document, set, path[0], labelled->label, path[1]);
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
