#pragma once
// Bounds of a probability of which passed cases of independent ones are known (Clopper and Pearson, 1934).

#include <cstddef>

namespace vbar::campaign_report {

/// A share with its bounds, all from 0 to 1.
struct PassRate {
  std::size_t passed = 0, of = 0;
  double lower = 0.0, upper = 1.0;

  [[nodiscard]] double share() const { return static_cast<double>(passed) / static_cast<double>(of); }
};

/// Two-sided bounds: each is exceeded with a probability of at most (1 - confidence) / 2. Without cases they are 0
/// and 1. Throws std::invalid_argument if more have passed than there are, or for a confidence outside (0, 1).
[[nodiscard]] PassRate pass_rate(std::size_t passed, std::size_t of, double confidence);

/// The one-sided lower bound, which a claim "at least" needs: exceeded with a probability of at most 1 - confidence.
/// Throws as above.
[[nodiscard]] double one_sided_lower_bound(std::size_t passed, std::size_t of, double confidence);

/// The number of cases, all of them passed, that show a pass rate of at least `rate` (one-sided). Throws
/// std::invalid_argument unless rate and confidence are inside (0, 1).
[[nodiscard]] std::size_t cases_needed(double rate, double confidence);

}  // namespace vbar::campaign_report
