#include "hil_drivers/bench_lines/json_table.h"

#include <cstdint>

#include <nlohmann/json.hpp>

#include "host_sim/mission/mission_error.h"

namespace vbar::bench_lines {

toml::table table_of_json(const std::string& line, const std::string& where, std::string_view example) {
  const nlohmann::json object = nlohmann::json::parse(line, nullptr, false);
  if (!object.is_object())
    throw mission::MissionError(where, "", "something else",
                                "one JSON object in a line, such as " + std::string(example));
  toml::table table;
  for (const auto& [key, value] : object.items()) {
    if (value.is_string())
      table.insert(key, value.get<std::string>());
    else if (value.is_number_integer())
      table.insert(key, value.get<std::int64_t>());
    else if (value.is_number())
      table.insert(key, value.get<double>());
    else
      throw mission::MissionError(where, key, value.dump().substr(0, 80), "a number or a text");
  }
  return table;
}

}  // namespace vbar::bench_lines
