#pragma once
// Mean and standard deviation of what a run counted.

#include <cmath>
#include <optional>
#include <vector>

#include "host_sim/report/summary.h"

namespace vbar::report {

/// Of at least one value.
[[nodiscard]] inline MeanAndDeviation statistics(const std::vector<double>& values) {
  double sum = 0.0, squares = 0.0;
  for (const double v : values) sum += v;
  const double mean = sum / static_cast<double>(values.size());
  for (const double v : values) squares += (v - mean) * (v - mean);
  return {mean, std::sqrt(squares / static_cast<double>(values.size()))};
}

/// None of no value.
[[nodiscard]] inline std::optional<double> mean_of(const std::vector<double>& values) {
  return values.empty() ? std::nullopt : std::optional(statistics(values).mean);
}

[[nodiscard]] inline std::optional<MeanAndDeviation> statistics_of(const std::vector<double>& values) {
  return values.empty() ? std::nullopt : std::optional(statistics(values));
}

}  // namespace vbar::report
