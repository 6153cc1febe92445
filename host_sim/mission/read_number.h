#pragma once
// Keys whose default is the value that the settings were made with.

#include <string_view>

#include "host_sim/mission/table_reader.h"

namespace vbar::mission {

inline void read(const TableReader& section, std::string_view key, Range range, double& value) {
  value = section.number(key, range, value);
}

inline void read(const TableReader& section, std::string_view key, int low, int high, int& value) {
  value = static_cast<int>(section.integer(key, low, high, value));
}

}  // namespace vbar::mission
