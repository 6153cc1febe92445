#pragma once
// Stretches of a run that can be drawn to one linear scale: a rendezvous from 75 km to 7 m is seen in three.

#include <string>
#include <vector>

#include "host_sim/report/run_record.h"

namespace vbar::report {

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

}  // namespace vbar::report
