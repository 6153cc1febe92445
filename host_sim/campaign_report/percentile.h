#pragma once
// Percentiles with bounds that hold for any continuous distribution: order statistics, chosen by the binomial
// distribution (Conover, Practical Nonparametric Statistics, 3rd ed., section 3.2). Where the values are too few for a
// bound it is open, never a number.

#include <cstddef>
#include <optional>
#include <vector>

namespace vbar::campaign_report {

/// Places among the sorted values, from 1; none where the bound is open.
struct PercentileRanks {
  std::optional<std::size_t> lower, upper;
};

/// Between the values of these ranks the `share` quantile of the distribution lies with a probability of at least
/// `confidence`, and beyond each with one of at most (1 - confidence) / 2. Both between 0 and 1, exclusive.
[[nodiscard]] PercentileRanks percentile_ranks(std::size_t count, double share, double confidence);

/// The least number of values for which the upper bound is closed.
[[nodiscard]] std::size_t values_needed(double share, double confidence);

struct Percentile {
  double share = 0.0;
  std::optional<double> estimate;  ///< only where the upper bound is closed: else the values do not support it
  std::optional<double> lower, upper;
};

/// Returns the percentile of independent, sorted values with its bounds.
[[nodiscard]] Percentile percentile(const std::vector<double>& sorted, double share, double confidence);

}  // namespace vbar::campaign_report
