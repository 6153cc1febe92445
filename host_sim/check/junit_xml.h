#pragma once
// Results as JUnit XML, which CI systems show beside their other tests: a suite for each run, a case for each limit.

#include <string>
#include <vector>

namespace vbar::check {

struct JunitCase {
  std::string name;
  std::string failure;  ///< empty: passed
};

struct JunitSuite {
  std::string name;
  double duration_s = 0.0;
  std::vector<JunitCase> cases;
};

/// The text of the file, UTF-8.
[[nodiscard]] std::string junit_xml(const std::vector<JunitSuite>& suites);

}  // namespace vbar::check
