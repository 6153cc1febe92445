#pragma once
// Figures of the cases that the page judges, and how their values are written.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host_sim/campaign_report/campaign.h"
#include "host_sim/report/svg_plot.h"

namespace vbar::campaign_report {

/// A figure of the complete cases with its limits.
struct Quantity {
  std::string key;
  std::optional<double> max, min;
  std::vector<double> values;  ///< in the order of Campaign::cases; NaN of a case that is not complete or lacks it

  [[nodiscard]] bool has_limit() const { return max || min; }
  /// Returns a positive number beyond a limit; without a limit the value itself: the larger, the worse.
  [[nodiscard]] double badness(double value) const;
};

/// Returns the quantities with pass criteria and, as a campaign may have none, the errors at the last waypoint and
/// delta-v; empty before a case is complete.
[[nodiscard]] std::vector<Quantity> quantities(const Campaign& campaign);

/// The values that there are.
[[nodiscard]] std::vector<double> sorted_values(const Quantity& quantity);

/// Writes a value with its unit, in which the key ends: "waypoints.10.navigation_error_m" of 0.004 is "4.00 mm".
[[nodiscard]] std::string value_text(std::string_view key, double value);

/// "most 20.0 mm", "at least 0.5"; empty without limits.
[[nodiscard]] std::string limits_text(const Quantity& quantity);

/// An axis of such values: "navigation error", in metres.
[[nodiscard]] report::Axis axis_of(std::string_view key);

/// A logarithmic axis shows the values better: all are positive, and the largest is many times the median.
[[nodiscard]] bool is_heavy_tailed(const std::vector<double>& sorted);

}  // namespace vbar::campaign_report
