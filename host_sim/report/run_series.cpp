#include "host_sim/report/run_series.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

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

namespace {

constexpr double kNearer = 20.0;

double range_m(const WaypointRow& row) {
  return magnitude(row.desired_position_rtn);
}

void complete(View& view, const RunRecord& record) {
  for (const WaypointRow& row : record.waypoints) {
    if (view.holds(row.time_s)) view.waypoints.push_back(row);
  }
  const bool is_start_only = view.waypoints.size() == 1 && is_start(record, view.waypoints.front());
  if (view.waypoints.empty() || is_start_only) {
    view.name = "whole run";
  } else if (view.waypoints.size() == 1) {
    view.name = fmt::format("waypoint {}", view.waypoints.front().index);
  } else {
    view.name = fmt::format("waypoints {} to {}", view.waypoints.front().index, view.waypoints.back().index);
  }
}

}  // namespace

bool is_start(const RunRecord& record, const WaypointRow& row) {
  return !record.truth.empty() && row.time_s <= record.truth.front().time_s;
}

std::vector<WaypointRow> reached_waypoints(const RunRecord& record) {
  std::vector<WaypointRow> reached;
  std::ranges::copy_if(record.waypoints, std::back_inserter(reached),
                       [&](const WaypointRow& row) { return !is_start(record, row); });
  return reached;
}

View whole_run(const RunRecord& record) {
  View view;
  if (!record.truth.empty()) {
    view.start_s = record.truth.front().time_s;
    view.end_s = record.truth.back().time_s;
  }
  complete(view, record);
  return view;
}

std::vector<View> mission_views(const RunRecord& record) {
  const View whole = whole_run(record);
  std::vector<double> bounds{whole.start_s};
  double first_range = 0.0;
  for (const WaypointRow& row : record.waypoints) {
    const double range = range_m(row);
    if (first_range == 0.0) first_range = range;
    if (range * kNearer > first_range) continue;
    bounds.push_back(row.time_s);
    first_range = range;
  }
  if (bounds.size() == 1 || bounds.back() < whole.end_s) bounds.push_back(whole.end_s);

  std::vector<View> views;
  for (std::size_t k = 0; k + 1 < bounds.size(); ++k) {
    View& view = views.emplace_back();
    view.start_s = bounds[k];
    view.end_s = bounds[k + 1];
    complete(view, record);
  }
  return views;
}

}  // namespace vbar::report
