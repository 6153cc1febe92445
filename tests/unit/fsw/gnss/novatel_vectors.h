#pragma once
// NovAtel's own ASCII test logs (tests/data/receiver/novatel_ascii_logs.txt), cut into fields.

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/paths.h"

namespace vbar::fsw::gnss::test {

inline std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, separator);) parts.push_back(part);
  return parts;
}

struct AsciiLog {
  unsigned week = 0;
  double time_of_week_s = 0.0;
  std::vector<std::string> body;
};

/// The log `name` (as RANGEA) of test case `test`.
inline AsciiLog ascii_log(const std::string& test, const std::string& name) {
  std::ifstream file(vbar::tests::source_path("tests/data/receiver/novatel_ascii_logs.txt"));
  AsciiLog log;
  std::string title;
  std::string line;
  std::getline(file, title);  // the source
  while (std::getline(file, title) && std::getline(file, line)) {
    if (title != "# " + test || line.rfind("#" + name + ",", 0) != 0) continue;
    const auto header = split(line.substr(0, line.find(';')), ',');
    log.week = static_cast<unsigned>(std::stoul(header[5]));
    log.time_of_week_s = std::stod(header[6]);
    log.body = split(line.substr(line.find(';') + 1, line.find('*') - line.find(';') - 1), ',');
    return log;
  }
  ADD_FAILURE() << "no log " << name << " of " << test;
  return log;
}

}  // namespace vbar::fsw::gnss::test
