#pragma once
// Whether the second of two independent samples is worse than the first.

#include <cstddef>
#include <vector>

namespace vbar::verification {

/// Returns the one-sided p value of Mann and Whitney (1947): of values of `later` at least as large against `earlier`,
/// if both are of one distribution. Exact for samples without equal values of which the smaller has at most 8, as in
/// common libraries; otherwise by the normal approximation with corrections for continuity and equal values. Infinite
/// values are the largest; 1 if a sample is empty.
[[nodiscard]] double mann_whitney_p(const std::vector<double>& earlier, const std::vector<double>& later);

/// Returns the one-sided p value of Fisher's exact test (1935): of at most `later_met` of the `later` cases that meet a
/// condition, given the numbers of both samples together.
[[nodiscard]] double fisher_p(std::size_t earlier_met, std::size_t earlier, std::size_t later_met, std::size_t later);

}  // namespace vbar::verification
