#pragma once
// Mean and standard deviation of what a run counted.

#include <cmath>
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

}  // namespace vbar::report
