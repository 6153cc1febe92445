#include <fmt/format.h>

#include "host_sim/report/code_names.h"
#include "host_sim/report/html_page.h"
#include "host_sim/report/maneuver_series.h"
#include "host_sim/report/number_text.h"
#include "host_sim/report/report_sections.h"
#include "host_sim/report/section_parts.h"
#include "host_sim/report/thrust.h"

namespace vbar::report {
namespace {

Plot cumulative_plot(const std::vector<ManeuverRow>& executed, const View& view) {
  Plot plot = time_plot(view, "Cumulative delta-v, " + view.name, "delta-v", Unit::kMetresPerSecond, 260.0);
  plot.series.push_back({"executed", 0, Mark::kStairs, cumulative_dv(executed, view)});
  plot.y.range = from_zero_to(plot.series.front().points.back().y);
  return plot;
}

/// Colour of maneuvers that no solver of the flight software planned.
constexpr int kNoSolverColour = 5;

Plot size_plot(const std::vector<ManeuverRow>& executed, const View& view) {
  Plot plot = time_plot(view, "Size of each maneuver by solver", "delta-v", Unit::kMetresPerSecond, 240.0);
  plot.y.logarithmic = true;
  std::vector<int> planners = solvers();
  planners.push_back(waypoint::kSolverNone);
  for (const int solver : planners) {
    Series series{"solver: " + solver_name(solver), solver < 0 ? kNoSolverColour : solver, Mark::kDots, {}};
    for (const ManeuverRow& row : executed) {
      if (row.solver != solver) continue;
      series.points.push_back({hours(row.execution_time_s), magnitude(row.executed_dv_rtn_mps)});
    }
    plot.series.push_back(std::move(series));
  }
  return plot;
}

const std::vector<Column> kManeuverColumns{{"id"},          {"leg to waypoint"}, {"solver", false}, {"commanded, h"},
                                           {"executed, h"}, {"dv R, mm/s"},      {"dv T, mm/s"},    {"dv N, mm/s"},
                                           {"|dv|, mm/s"},  {"outcome", false}};

std::vector<std::string> cells(const ManeuverRow& row) {
  const Triple& dv = row.accepted ? row.executed_dv_rtn_mps : row.commanded_dv_rtn_mps;
  return {std::to_string(row.maneuver_id),
          row.waypoint_index < 0 ? "–" : std::to_string(row.waypoint_index),
          solver_name(row.solver),
          fixed(hours(row.command_time_s), 4),
          fixed(hours(row.execution_time_s), 4),
          fixed(1e3 * dv[0], 4),
          fixed(1e3 * dv[1], 4),
          fixed(1e3 * dv[2], 4),
          fixed(1e3 * magnitude(dv), 4),
          row.accepted ? "executed" : "not executed"};
}

}  // namespace

Section maneuver_section(const RunRecord& record) {
  if (record.maneuvers.empty()) return {"Maneuvers", "<p>None was commanded.</p>\n"};
  const std::vector<ManeuverRow> executed = executed_in_order(record);
  const View whole = whole_run(record);
  const std::vector<View> views = mission_views(record);
  std::vector<Plot> cumulative{cumulative_plot(executed, whole)};
  cumulative.front().title = "Cumulative delta-v, whole run";
  if (views.size() > 1) cumulative.push_back(cumulative_plot(executed, views.back()));
  std::vector<std::vector<std::string>> rows;
  for (const ManeuverRow& row : record.maneuvers) rows.push_back(cells(row));
  const std::string thrust = thrust_line(record.summary);
  return {"Maneuvers",
          fmt::format("<p>{} commanded, {} executed, {} not executed. Dashed vertical lines: waypoints.</p>\n",
                      rows.size(), executed.size(), rows.size() - executed.size()) +
              (thrust.empty() ? "" : fmt::format("<p>{}</p>\n", escaped(thrust))) +
              plot_rows(2, std::move(cumulative)) + plot_rows(1, {size_plot(executed, whole)}, 1) +
              fmt::format("<details><summary>All {} maneuvers, in the servicer's RTN frame</summary>", rows.size()) +
              table(kManeuverColumns, rows) + "</details>\n",
          {"maneuvers.csv"}};
}

}  // namespace vbar::report
