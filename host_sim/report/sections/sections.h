#pragma once
// The sections of a run's report. One that has nothing to show has no content.

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host_sim/report/plots/html_page.h"
#include "host_sim/report/plots/svg_plot.h"
#include "host_sim/report/run_record.h"
#include "host_sim/report/run_series.h"
#include "host_sim/report/statistics.h"

namespace vbar::report {

/// Mission, end of the run, its figures, and what failed (overview.cpp).
[[nodiscard]] std::string overview(const RunRecord& record);

/// Flight software, seed, checksums, commit and computer: what identifies the run (overview.cpp).
[[nodiscard]] Section flown_section(const RunRecord& record);

/// Distance, accuracy, aiding sources and maneuvers of the whole run (overview.cpp).
[[nodiscard]] Section glance_section(const RunRecord& record);
/// Faults of the scenario and of the flight software (flight_computer.cpp).
[[nodiscard]] Section faults_section(const RunRecord& record);

/// The paper's performance metrics at each waypoint (maneuvers.cpp).
[[nodiscard]] Section waypoint_section(const RunRecord& record);

/// Motion of the target about the servicer, in its RTN planes (trajectory.cpp).
[[nodiscard]] Section trajectory_section(const RunRecord& record);

/// Mean ROE: true, estimated, desired (trajectory.cpp).
[[nodiscard]] Section elements_section(const RunRecord& record);

/// Delta-v over time and all maneuvers (maneuvers.cpp).
[[nodiscard]] Section maneuver_section(const RunRecord& record);

/// Errors of navigation and the bounds that its filter claims (navigation.cpp).
[[nodiscard]] Section navigation_section(const RunRecord& record);

/// True attitudes and rates (trajectory.cpp).
[[nodiscard]] Section attitude_section(const RunRecord& record);

/// Actions of guidance over time, and how near the target may drift (maneuvers.cpp).
[[nodiscard]] Section guidance_section(const RunRecord& record);

/// Counts of the flight software: packets rejected and dropped, plans rejected, faults (flight_computer.cpp).
[[nodiscard]] Section health_section(const RunRecord& record);

/// Cost of each flight step, link, deadlines and where the wall-clock time went (flight_computer.cpp).
[[nodiscard]] Section computer_section(const RunRecord& record);

// Elements of plots that several sections share.

inline constexpr std::array<const char*, 6> kElementNames{"aδa", "aδλ", "aδex", "aδey", "aδix", "aδiy"};

/// Mean elements scatter by millimetres; a smaller range would show nothing else.
inline constexpr double kMinElementSpan_m = 0.02;

/// Figures a row so that plots of one view stand below each other.
inline int columns_for(std::size_t views) {
  return views == 1 || views == 3 ? 3 : 2;
}

/// The hours of a view; a minute even for a run that ended with its first step.
inline Range hours_of(const View& view) {
  return {hours(view.start_s), hours(std::max(view.end_s, view.start_s + 60.0))};
}

/// A time axis that shows just the view.
inline Axis time_axis(const View& view) {
  return {.name = "time", .unit = Unit::kHours, .range = hours_of(view)};
}

/// The waypoints of a view as dashed lines with their numbers.
inline std::vector<Moment> waypoint_moments(const View& view) {
  std::vector<Moment> moments;
  for (const WaypointRow& row : view.waypoints) moments.push_back({hours(row.time_s), std::to_string(row.index)});
  return moments;
}

/// Returns the times of the executed maneuvers of a view.
inline std::vector<double> maneuver_events(const RunRecord& record, const View& view) {
  std::vector<double> events;
  for (const ManeuverRow& row : record.maneuvers) {
    if (row.accepted && view.holds(row.execution_time_s)) events.push_back(hours(row.execution_time_s));
  }
  return events;
}

/// A plot over the time of a view, with its waypoints and, if there is a record, its maneuvers.
inline Plot time_plot(const View& view, std::string title, std::string quantity, Unit unit, double height = 250.0,
                      const RunRecord* record = nullptr) {
  Plot plot;
  plot.title = std::move(title);
  plot.x = time_axis(view);
  plot.y = {.name = std::move(quantity), .unit = unit};
  plot.height = height;
  plot.moments = waypoint_moments(view);
  if (record != nullptr) plot.events = maneuver_events(*record, view);
  return plot;
}

/// A plane of the servicer's RTN frame: which component is the abscissa, which the ordinate.
struct RtnPlane {
  const char* title;
  std::size_t x, y;
  const char* x_name;
  const char* y_name;

  [[nodiscard]] Point of(const Triple& position_rtn) const { return {position_rtn[x], position_rtn[y]}; }
};
inline constexpr std::array<RtnPlane, 3> kRtnPlanes{{{"T-R", 1, 0, "along track T", "radial R"},
                                                     {"N-R", 2, 0, "cross track N", "radial R"},
                                                     {"T-N", 1, 2, "along track T", "cross track N"}}};

/// The positions of a view in a plane.
inline Plot plane_plot(const View& view, const RtnPlane& plane) {
  Plot plot;
  plot.title = std::string(plane.title) + ", " + view.name;
  plot.x = {.name = plane.x_name, .unit = Unit::kMetres, .min_span = 0.01};
  plot.y = {.name = plane.y_name, .unit = Unit::kMetres, .min_span = 0.01};
  return plot;
}

/// The true path of a run within a view.
inline std::vector<Point> path_in(const RtnPlane& plane, const View& view, const RunRecord& record) {
  std::vector<Point> points;
  for (const TruthRow& row : record.truth)
    if (view.holds(row.time_s)) points.push_back(plane.of(row.relative_position_rtn));
  return points;
}

/// Explanation of the moments and events of a plot, as HTML.
inline constexpr const char* kPlotNote =
    "<p class=\"note\">Dashed vertical lines: waypoints. Strokes on the lower edge: maneuvers.</p>\n";

/// Returns the time at which the errors of navigation have settled, five minutes after the first fix; the start of a
/// view that begins later or ends sooner. Axes of errors show the errors after it.
inline double settled_from(const RunRecord& record, const View& view) {
  constexpr double kSettling_s = 300.0;
  const std::optional<double> fix_s = first_fix(record);
  if (!fix_s || *fix_s + kSettling_s >= view.end_s) return view.start_s;
  return std::max(view.start_s, *fix_s + kSettling_s);
}

/// (time in hours, value(row)) of all rows inside the view.
template <class Row, class Value>
std::vector<Point> over_time(const std::vector<Row>& rows, const View& view, const Value& value) {
  std::vector<Point> points;
  for (const Row& row : rows) {
    if (view.holds(row.time_s)) points.push_back({hours(row.time_s), value(row)});
  }
  return points;
}

}  // namespace vbar::report
