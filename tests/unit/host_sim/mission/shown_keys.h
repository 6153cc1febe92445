#pragma once
// Which keys a mission's tables accept, and what a mission file shows and says of them.

#include <algorithm>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "host_sim/mission/load.h"
#include "host_sim/mission/mission_error.h"

namespace vbar::mission::test {

inline std::string text_of_file(const std::string& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

/// The keys that a table of a mission accepts, as the message about an unknown one lists them.
inline std::vector<std::string> accepted_keys(const std::string& file, const std::string& table) {
  std::string message;
  try {
    static_cast<void>(load_mission(file, std::vector<std::string>{table + ".xyzzy=1"}));
  } catch (const MissionError& error) {
    message = error.what();
  }
  const std::string before = "accepted: ";
  const std::size_t start = message.find(before);
  EXPECT_NE(start, std::string::npos) << table << ": " << message;
  if (start == std::string::npos) return {};
  std::string list = message.substr(start + before.size());  // "a, b or c"
  std::replace(list.begin(), list.end(), ',', ' ');
  std::istringstream words(list);
  std::vector<std::string> keys;
  for (std::string word; words >> word;)
    if (word != "or") keys.push_back(word);
  return keys;
}

/// Each key that these tables accept stands in the text, with a value or as a table.
inline void expect_all_shown(const std::string& text, const std::string& file, const std::vector<std::string>& tables) {
  for (const std::string& table : tables) {
    const std::vector<std::string> keys = accepted_keys(file, table);
    EXPECT_GE(keys.size(), 4U) << table;
    for (const std::string& key : keys) {
      const bool is_shown = text.find("\n" + key + " = ") != std::string::npos ||
                            text.find("." + key + "]") != std::string::npos ||
                            text.find("\n[" + key + "]") != std::string::npos;
      EXPECT_TRUE(is_shown) << table << '.' << key;
    }
  }
}

}  // namespace vbar::mission::test
