#include "host_sim/report/maneuver_series.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace vbar::report {

std::vector<ManeuverRow> executed_in_order(const RunRecord& record) {
  std::vector<ManeuverRow> executed;
  std::ranges::copy_if(record.maneuvers, std::back_inserter(executed), &ManeuverRow::accepted);
  std::ranges::stable_sort(executed, {}, &ManeuverRow::execution_time_s);
  return executed;
}

std::vector<Point> cumulative_dv(const std::vector<ManeuverRow>& executed, const View& view) {
  std::vector<Point> points{{hours(view.start_s), 0.0}};
  double total = 0.0;
  for (const ManeuverRow& row : executed) {
    if (!view.holds(row.execution_time_s)) continue;
    total += magnitude(row.executed_dv_rtn_mps);
    points.push_back({hours(row.execution_time_s), total});
  }
  points.push_back({hours(view.end_s), total});
  return points;
}

Range from_zero_to(double most) {
  return {0.0, most > 0.0 ? 1.06 * most : 1.0};
}

}  // namespace vbar::report
