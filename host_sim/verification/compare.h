#pragma once
// Two verifications against each other: rows whose later cases are worse beyond the scatter of both.

#include <string>
#include <vector>

#include "host_sim/verification/record.h"

namespace vbar::verification {

/// Probability, over all comparisons together, of naming any row although none is worse (Holm's correction).
inline constexpr double kFamilyLevel = 0.01;

struct Worsening {
  std::string row, what;
  double earlier = 0.0, later = 0.0;  ///< medians; shares of achieved cases
  std::size_t earlier_cases = 0, later_cases = 0;
  double adjusted_p = 1.0;
};

struct Comparison {
  std::vector<Worsening> worse;           ///< the least probable first
  std::size_t tests = 0;                  ///< comparisons made
  std::vector<std::string> not_compared;  ///< rows that one of both has not flown
};

/// Compares the quantities of every row by the rank test of Mann and Whitney, in which a lost case is the worst, and
/// the share of achieved cases by Fisher's exact test.
[[nodiscard]] Comparison compare(const Json& earlier, const Json& later);

/// Returns the comparison in lines for a reader.
[[nodiscard]] std::string text_of(const Comparison& comparison);

}  // namespace vbar::verification
