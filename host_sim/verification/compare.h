#pragma once
// Two verifications against each other: rows whose later cases are worse beyond the scatter of both.

#include <cstddef>
#include <string>
#include <vector>

#include "host_sim/verification/record.h"

namespace vbar::verification {

// Whether the second of two independent samples is worse than the first.

/// Returns the one-sided p value of Mann and Whitney (1947): of values of `later` at least as large against `earlier`,
/// if both are of one distribution. Exact for samples without equal values of which the smaller has at most 8, as in
/// common libraries; otherwise by the normal approximation with corrections for continuity and equal values. Infinite
/// values are the largest; 1 if a sample is empty.
[[nodiscard]] double mann_whitney_p(const std::vector<double>& earlier, const std::vector<double>& later);

/// Returns the one-sided p value of Fisher's exact test (1935): of at most `later_met` of the `later` cases that meet a
/// condition, given the numbers of both samples together.
[[nodiscard]] double fisher_p(std::size_t earlier_met, std::size_t earlier, std::size_t later_met, std::size_t later);

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
