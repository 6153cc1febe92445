#include <algorithm>

#include <fmt/format.h>

#include "host_sim/report/code_names.h"
#include "host_sim/report/html_page.h"
#include "host_sim/report/maneuver_series.h"
#include "host_sim/report/number_text.h"
#include "host_sim/report/report_sections.h"
#include "host_sim/report/section_parts.h"

namespace vbar::report {
namespace {

Plot cumulative_plot(const std::vector<ManeuverRow>& executed, const View& view, const std::string& title) {
  Plot plot;
  plot.title = title;
  plot.x = time_axis(view);
  plot.y = {.name = "delta-v", .unit = Unit::kMetresPerSecond};
  plot.width = 580.0;
  plot.height = 260.0;
  plot.moments = waypoint_moments(view);
  plot.series.push_back({"executed", 0, Mark::kStairs, cumulative_dv(executed, view)});
  plot.y.range = from_zero_to(plot.series.front().points.back().y);
  return plot;
}

Plot size_plot(const std::vector<ManeuverRow>& executed, const View& view) {
  Plot plot;
  plot.title = "Size of each maneuver by the solver that planned it";
  plot.x = time_axis(view);
  plot.y = {.name = "delta-v", .unit = Unit::kMetresPerSecond, .logarithmic = true};
  plot.width = 1190.0;
  plot.height = 240.0;
  plot.moments = waypoint_moments(view);
  for (int solver = 0; solver < 3; ++solver) {
    Series series{solver_name(solver), solver, Mark::kDots, {}};
    for (const ManeuverRow& row : executed) {
      if (row.solver == solver) {
        series.points.push_back({hours(row.execution_time_s), magnitude(row.executed_dv_rtn_mps)});
      }
    }
    if (!series.points.empty()) plot.series.push_back(std::move(series));
  }
  return plot;
}

const std::vector<Column> kColumns{{"id"},          {"leg to waypoint"}, {"solver", false}, {"commanded, h"},
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

std::string maneuver_section(const RunRecord& record) {
  if (record.maneuvers.empty()) return section("Maneuvers", "<p>None was commanded.</p>\n");
  const std::vector<ManeuverRow> executed = executed_in_order(record);
  const View whole = whole_run(record);
  std::vector<std::string> plots{svg(cumulative_plot(executed, whole, "Cumulative delta-v, whole run"))};
  const std::vector<View> views = mission_views(record);
  if (views.size() > 1) {
    plots.push_back(svg(cumulative_plot(executed, views.back(), "Cumulative delta-v, " + views.back().name)));
  }
  std::vector<std::vector<std::string>> rows;
  for (const ManeuverRow& row : record.maneuvers) rows.push_back(cells(row));
  const Plot sizes = size_plot(executed, whole);
  const auto refused = static_cast<std::size_t>(std::ranges::count(record.maneuvers, false, &ManeuverRow::accepted));
  return section("Maneuvers",
                 fmt::format("<p>{} commanded, {} executed, {} not executed; dashed lines are waypoints.</p>\n",
                             record.maneuvers.size(), executed.size(), refused) +
                     figures(2, plots) + legend(sizes.series) + figures(1, {svg(sizes)}) +
                     fmt::format("<details><summary>All {} maneuvers, in the servicer's RTN frame</summary>",
                                 record.maneuvers.size()) +
                     table(kColumns, rows) + "</details>\n");
}

}  // namespace vbar::report
