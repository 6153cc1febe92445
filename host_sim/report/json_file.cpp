#include "host_sim/report/json_file.h"

#include <algorithm>

#include "host_sim/files/output_file.h"

namespace vbar::report {

Json read_json_file(const std::filesystem::path& file) {
  const std::string text = files::read_text_file(file);
  try {
    return Json::parse(text);
  } catch (const Json::parse_error& error) {
    // The byte counts from 1, and is behind the end of a text that ends too early.
    const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::min(error.byte, text.size()));
    const auto line = 1 + std::count(text.begin(), end, '\n');
    throw std::runtime_error(
        fmt::format("{}:{}: the file is {}; accepted: a whole JSON file, as this program writes it", file.string(),
                    line, error.byte > text.size() ? "cut off here" : "damaged here"));
  }
}

JsonObject::JsonObject(const Json& json, std::string place) : json_(json), place_(std::move(place)) {
  if (!json.is_object()) throw std::runtime_error(place_ + ": a JSON object is expected");
}

void JsonObject::fail(const char* key, const std::string& what) const {
  throw std::runtime_error(fmt::format("{}: key \"{}\": {}", place_, key, what));
}

const Json& JsonObject::at(const char* key) const {
  const auto found = json_.find(key);
  if (found == json_.end()) fail(key, "is missing");
  return *found;
}

std::size_t JsonObject::count(const char* key) const {
  const Json& value = at(key);
  if (!value.is_number_unsigned()) fail(key, value.dump() + " is not an integer from 0 on");
  return value.get<std::size_t>();
}

double JsonObject::number(const char* key) const {
  const double value = get<double>(key, "a number");
  if (!std::isfinite(value)) fail(key, "is not finite");
  return value;
}

std::optional<double> JsonObject::number_or_null(const char* key) const {
  return has(key) && !at(key).is_null() ? std::optional(number(key)) : std::nullopt;
}

double JsonObject::probability(const char* key) const {
  const double value = number(key);
  if (!(value > 0.0 && value < 1.0)) fail(key, fmt::format("{} is not between 0 and 1", value));
  return value;
}

std::vector<JsonObject> JsonObject::objects(const char* key) const {
  const Json& list = at(key);
  if (!list.is_array()) fail(key, "a list is expected");
  std::vector<JsonObject> all;
  for (const Json& element : list) all.emplace_back(element, fmt::format("{}: {}[{}]", place_, key, all.size()));
  return all;
}

}  // namespace vbar::report
