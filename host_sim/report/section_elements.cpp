#include <cmath>

#include <fmt/format.h>

#include "host_sim/report/html_page.h"
#include "host_sim/report/number_text.h"
#include "host_sim/report/report_sections.h"
#include "host_sim/report/section_parts.h"

namespace vbar::report {
namespace {

/// A flight computer without mean ROE reports zeros.
bool has_estimate(const EstimateRow& row) {
  return row.navigation_valid != 0 && row.a_roe_mean_m != Sextuple{};
}

Plot element_plot(const RunRecord& record, const View& view, std::size_t k) {
  Plot plot =
      time_plot(view, fmt::format("{}, {}", kElementNames[k], view.name), kElementNames[k], Unit::kMetres, 220.0);
  plot.y.least_span = kLeastElementSpan_m;
  plot.series = {{"true", 0, Mark::kBroadLine,
                  over_time(record.truth, view, [k](const TruthRow& r) { return r.a_roe_mean_m[k]; })},
                 {"estimated", 1, Mark::kLine,
                  over_time(record.estimates, view,
                            [k](const EstimateRow& r) { return has_estimate(r) ? r.a_roe_mean_m[k] : std::nan(""); })},
                 {"desired at the next waypoint", 5, Mark::kDashedLine, {}}};
  std::vector<Point>& desired = plot.series[2].points;
  for (const EstimateRow& row : record.estimates) {
    if (!view.holds(row.time_s) || row.waypoint_index < 0) continue;
    // The desired elements change at once with the next waypoint.
    if (!desired.empty() && desired.back().y != row.a_roe_desired_m[k]) {
      desired.push_back({hours(row.time_s), desired.back().y});
    }
    desired.push_back({hours(row.time_s), row.a_roe_desired_m[k]});
  }
  for (const WaypointRow& row : view.waypoints) {
    plot.rings.push_back({{hours(row.time_s), row.a_roe_desired_m[k]},
                          "",
                          fmt::format("waypoint {}: {} m desired, {} m true", row.index,
                                      fixed(row.a_roe_desired_m[k], 3), fixed(row.a_roe_actual_m[k], 3))});
  }
  return plot;
}

}  // namespace

Section elements_section(const RunRecord& record) {
  if (record.truth.empty()) return {};
  const std::vector<View> views = mission_views(record);
  std::vector<Plot> plots;
  for (std::size_t k = 0; k < kElementNames.size(); ++k) {
    for (const View& view : views) plots.push_back(element_plot(record, view, k));
  }
  return {"Relative orbital elements",
          "<p class=\"note\">Mean ROE of the target with respect to the servicer, times the reference semi-major axis. "
          "Rings and dashed vertical lines: waypoints.</p>\n" +
              plot_rows(columns_for(views.size()), std::move(plots)),
          {"truth.csv", "estimate.csv"}};
}

}  // namespace vbar::report
