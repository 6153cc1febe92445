#pragma once
// The limits of a mission against the numbers of a run's summary.

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "host_sim/mission/mission.h"

namespace vbar::check {

/// Returns false for a number that is missing or not finite.
[[nodiscard]] bool meets(const mission::Limit& limit, const std::optional<double>& value);

struct LimitResult {
  mission::Limit limit;
  std::optional<double> value;  ///< none: the summary has no such number
  bool met = false;
  std::string missed;  ///< if not met: a sentence that says by what
};

/// Returns the results in the order of the limits. A key without a number is answered with the nearest one that has.
[[nodiscard]] std::vector<LimitResult> check_limits(std::span<const mission::Limit> limits,
                                                    std::span<const std::pair<std::string, double>> numbers);

/// "at most 0.02", "0.5 to 1.5".
[[nodiscard]] std::string text_of(const mission::Limit& limit);

// Results as JUnit XML, which CI systems show beside their other tests: a suite for each run, a case for each limit.

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
