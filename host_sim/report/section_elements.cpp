#include <fmt/format.h>

#include "host_sim/report/html_page.h"
#include "host_sim/report/number_text.h"
#include "host_sim/report/report_sections.h"
#include "host_sim/report/section_parts.h"

namespace vbar::report {
namespace {

Plot element_plot(const RunRecord& record, const View& view, std::size_t k) {
  Plot plot;
  plot.title = fmt::format("{}, {}", kElementNames[k], view.name);
  plot.x = time_axis(view);
  plot.y = {.name = kElementNames[k], .unit = Unit::kMetres, .least_span = kLeastElementSpan_m};
  plot.height = 220.0;
  plot.moments = waypoint_moments(view);
  plot.series = {{"true", 0, Mark::kBroadLine,
                  over_time(record.truth, view, [k](const TruthRow& r) { return r.a_roe_mean_m[k]; })},
                 {"estimated", 1, Mark::kLine, {}},
                 {"wanted at the next waypoint", 5, Mark::kDashedLine, {}}};
  for (const EstimateRow& row : record.estimates) {
    if (!view.holds(row.time_s)) continue;
    if (row.navigation_valid != 0) plot.series[1].points.push_back({hours(row.time_s), row.a_roe_mean_m[k]});
    std::vector<Point>& wanted = plot.series[2].points;
    if (row.waypoint_index < 0) continue;
    // A new waypoint is wanted at once, not by and by.
    if (!wanted.empty() && wanted.back().y != row.a_roe_desired_m[k]) {
      wanted.push_back({hours(row.time_s), wanted.back().y});
    }
    wanted.push_back({hours(row.time_s), row.a_roe_desired_m[k]});
  }
  for (const WaypointRow& row : view.waypoints) {
    plot.rings.push_back({{hours(row.time_s), row.a_roe_desired_m[k]},
                          "",
                          fmt::format("waypoint {}: {} m wanted, {} m true", row.index,
                                      fixed(row.a_roe_desired_m[k], 3), fixed(row.a_roe_actual_m[k], 3))});
  }
  return plot;
}

}  // namespace

std::string elements_section(const RunRecord& record) {
  if (record.truth.empty()) return {};
  const std::vector<View> views = mission_views(record);
  std::vector<std::string> plots;
  for (std::size_t k = 0; k < kElementNames.size(); ++k) {
    for (const View& view : views) plots.push_back(svg(element_plot(record, view, k)));
  }
  return section(
      "Relative orbital elements",
      "<p class=\"note\">Mean ROE of the target with respect to the servicer, times the reference semi-major axis. "
      "Rings and dashed lines: waypoints.</p>\n" +
          legend(element_plot(record, views.front(), 0).series) + figures(columns_for(views.size()), plots));
}

}  // namespace vbar::report
