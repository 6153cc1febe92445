#pragma once
// Maneuvers as curves over time.

#include <vector>

#include "host_sim/report/mission_views.h"
#include "host_sim/report/plot_axis.h"
#include "host_sim/report/polyline.h"

namespace vbar::report {

/// Returns the executed maneuvers in the order of their execution times.
[[nodiscard]] std::vector<ManeuverRow> executed_in_order(const RunRecord& record);

/// (hours, m/s) executed since the start of the view, from its start to its end; each value holds until the next.
[[nodiscard]] std::vector<Point> cumulative_dv(const std::vector<ManeuverRow>& executed, const View& view);

/// A range with a little room above, for curves that start at zero.
[[nodiscard]] Range from_zero_to(double most);

}  // namespace vbar::report
