#pragma once
// Which keys a mission's tables accept, and what a mission file shows and says of them.

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "host_sim/sensors/sensor_kinds.h"

namespace vbar::mission::test {

inline std::string text_of_file(const std::string& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

inline std::vector<std::string> names_of(const std::vector<AcceptedKey>& keys) {
  std::vector<std::string> names;
  for (const AcceptedKey& key : keys) names.push_back(key.name);
  return names;
}

/// Each key that these tables accept stands in the text, with a value or as a table.
inline void expect_all_shown(const std::string& text, const std::string& file, const std::vector<std::string>& tables) {
  const auto accepted = accepted_keys(file, {}, sensors::installation());
  for (const std::string& table : tables) {
    ASSERT_TRUE(accepted.contains(table)) << table;
    const std::vector<AcceptedKey>& keys = accepted.at(table);
    EXPECT_GE(keys.size(), 4U) << table;
    for (const std::string& key : names_of(keys)) {
      const bool is_shown = text.find("\n" + key + " = ") != std::string::npos ||
                            text.find("." + key + "]") != std::string::npos ||
                            text.find("\n[" + key + "]") != std::string::npos;
      EXPECT_TRUE(is_shown) << table << '.' << key;
    }
  }
}

}  // namespace vbar::mission::test
