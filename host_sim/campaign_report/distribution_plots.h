#pragma once
// Histogram and empirical distribution function of a figure, with its limits.

#include <vector>

#include "host_sim/campaign_report/quantity.h"
#include "host_sim/report/svg_plot.h"

namespace vbar::campaign_report {

/// Both plots are of at least one value, sorted.
[[nodiscard]] report::Plot histogram(const Quantity& quantity, const std::vector<double>& sorted);
[[nodiscard]] report::Plot distribution_function(const Quantity& quantity, const std::vector<double>& sorted);

/// The steps of an empirical distribution function, at most `max_steps` of them and both ends: (value, share of the
/// values up to it).
[[nodiscard]] std::vector<report::Point> distribution_steps(const std::vector<double>& sorted, std::size_t max_steps);

}  // namespace vbar::campaign_report
