#pragma once
// Maneuvers as curves over time.

#include <string>
#include <vector>

#include "host_sim/report/plots/plot_axis.h"
#include "host_sim/report/run_record.h"

namespace vbar::report {

// Stretches of a run that can be drawn to one linear scale: a rendezvous from 75 km to 7 m is seen in three.

inline constexpr double kSecondsPerHour = 3600.0;

inline double hours(double seconds) {
  return seconds / kSecondsPerHour;
}

struct View {
  std::string name;  ///< e.g. "waypoints 4 to 8"
  double start_s = 0.0, end_s = 0.0;
  std::vector<WaypointRow> waypoints;  ///< within the view, ends included

  [[nodiscard]] bool holds(double time_s) const { return time_s >= start_s && time_s <= end_s; }
};

/// Returns the views in order of time, without gaps. A new view begins at a waypoint that is 20 times nearer than the
/// one the view began with; the leg that leads there still belongs to the view before. One view for a run without
/// waypoints.
[[nodiscard]] std::vector<View> mission_views(const RunRecord& record);

/// Returns whether the run began at this waypoint, which was then not flown to.
[[nodiscard]] bool is_start(const RunRecord& record, const WaypointRow& row);

/// The waypoints that the run was flown to.
[[nodiscard]] std::vector<WaypointRow> reached_waypoints(const RunRecord& record);

/// The whole run in one.
[[nodiscard]] View whole_run(const RunRecord& record);

/// Returns the executed maneuvers in the order of their execution times.
[[nodiscard]] std::vector<ManeuverRow> executed_in_order(const RunRecord& record);

/// (hours, m/s) executed since the start of the view, from its start to its end; each value holds until the next.
[[nodiscard]] std::vector<Point> cumulative_dv(const std::vector<ManeuverRow>& executed, const View& view);

/// A range with a little room above, for curves that start at zero.
[[nodiscard]] Range from_zero_to(double most);

}  // namespace vbar::report
