#pragma once
// Mean, standard deviation and quantiles of what a run counted.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "host_sim/report/summary.h"

namespace vbar::report {

/// Returns mean and standard deviation of at least one value.
[[nodiscard]] inline MeanAndDeviation statistics(const std::vector<double>& values) {
  double sum = 0.0, squares = 0.0;
  for (const double v : values) sum += v;
  const double mean = sum / static_cast<double>(values.size());
  for (const double v : values) squares += (v - mean) * (v - mean);
  return {mean, std::sqrt(squares / static_cast<double>(values.size()))};
}

/// Returns the mean, empty if there is no value.
[[nodiscard]] inline std::optional<double> mean_of(const std::vector<double>& values) {
  return values.empty() ? std::nullopt : std::optional(statistics(values).mean);
}

[[nodiscard]] inline std::optional<MeanAndDeviation> statistics_of(const std::vector<double>& values) {
  return values.empty() ? std::nullopt : std::optional(statistics(values));
}

/// Returns the smallest of at least one sorted value that is not below that share of them.
[[nodiscard]] inline double quantile(const std::vector<double>& sorted, double share) {
  const auto place = static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size())));
  return sorted[std::clamp<std::size_t>(place, 1, sorted.size()) - 1];
}

}  // namespace vbar::report
