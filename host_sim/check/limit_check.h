#pragma once
// The limits of a mission against the numbers of a run's summary.

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "host_sim/mission/limit.h"

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

}  // namespace vbar::check
