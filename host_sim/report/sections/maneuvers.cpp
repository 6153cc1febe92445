#include <algorithm>

#include <fmt/format.h>

#include "host_sim/report/plots/html_page.h"
#include "host_sim/report/plots/number_text.h"
#include "host_sim/report/plots/svg_plot.h"
#include "host_sim/report/run_series.h"
#include "host_sim/report/sections/sections.h"
#include "host_sim/report/statistics.h"
#include "host_sim/report/words.h"

namespace vbar::report {

namespace {

const std::vector<Column> kWaypointColumns{{"waypoint"},
                                           {"time, h"},
                                           {"control error, m"},
                                           {"navigation error, m"},
                                           {"navigation velocity error, mm/s"},
                                           {"delta-v of leg, m/s"},
                                           {"cumulative delta-v, m/s"},
                                           {"maneuvers in leg"}};

std::string name_of(const RunRecord& record, const WaypointRow& row) {
  return fmt::format("{}{}", row.index, is_start(record, row) ? " (start)" : "");
}

std::vector<std::string> cells(const RunRecord& record, const WaypointRow& row) {
  std::optional<double> velocity_error_mmps;
  if (row.navigation_velocity_error_mps) velocity_error_mmps = 1e3 * *row.navigation_velocity_error_mps;
  // At the start there is nothing yet to control.
  const std::optional<double> control_error_m =
      is_start(record, row) ? std::nullopt : std::optional(row.control_error_m);
  return {name_of(record, row),
          fixed(row.time_s / 3600.0, 2),
          fixed(control_error_m, 4),
          fixed(row.navigation_error_m, 4),
          fixed(velocity_error_mmps, 4),
          fixed(row.leg_dv_mps, 5),
          fixed(row.cumulative_dv_mps, 5),
          std::to_string(row.leg_maneuvers)};
}

std::string mean_and_deviation(const char* name, const std::optional<MeanAndDeviation>& value, double scale,
                               const char* unit, const char* over = "over all steps") {
  if (!value) return {};
  return fmt::format("<p>{}: {} ± {} {} (mean and standard deviation {})</p>\n", name,
                     significant(value->mean * scale, 3), significant(value->std * scale, 3), unit, over);
}

const std::vector<Column> kRoeColumns{{"waypoint"}, {"", false}, {"aδa, m"},  {"aδλ, m"},
                                      {"aδex, m"},  {"aδey, m"}, {"aδix, m"}, {"aδiy, m"}};

std::vector<std::string> roe_cells(const std::string& name, const char* what, const Sextuple& a_roe_m) {
  std::vector<std::string> cells{name, what};
  for (const double component : a_roe_m) cells.push_back(fixed(component, 3));
  return cells;
}

}  // namespace

Section waypoint_section(const RunRecord& record) {
  if (record.waypoints.empty()) return {"Waypoints", "<p>No waypoint was reached.</p>\n"};
  std::vector<std::vector<std::string>> rows, roe_rows;
  for (const WaypointRow& row : record.waypoints) {
    rows.push_back(cells(record, row));
    roe_rows.push_back(roe_cells(name_of(record, row), "desired", row.a_roe_desired_m));
    roe_rows.push_back(roe_cells(name_of(record, row), "true", row.a_roe_actual_m));
  }
  const Summary& s = record.summary;
  std::string out = table(kWaypointColumns, rows);
  if (reached_waypoints(record).empty()) out += "<p>No waypoint was reached after the start.</p>\n";
  const char* const over = s.first_fix_s ? "from the first fix on" : "over all steps";
  out += mean_and_deviation("Navigation error", s.navigation_error_m, 1.0, "m", over);
  out += mean_and_deviation("Navigation velocity error", s.navigation_velocity_error_mps, 1e3, "mm/s", over);
  out += mean_and_deviation("Attitude error", s.attitude_error_deg, 1.0, "deg");
  out +=
      "<p class=\"note\">Control error: distance between the true RTN position of the target and the position that "
      "corresponds to the desired mean ROE on the true orbit of the servicer, before any maneuver at that instant. "
      "Navigation error: distance between estimated and true RTN position. A maneuver belongs to the leg of the "
      "waypoint for which it was commanded.</p>\n";
  out += "<details><summary>Mean ROE at the waypoints</summary>" + table(kRoeColumns, roe_rows) + "</details>\n";
  return {"Waypoints", out, {"waypoints.csv"}};
}

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

namespace {

constexpr int kWarningColour = 6;

/// Stretches over which `code(row)` keeps its value; those for which `describe` gives no text are left out.
template <class Code, class Describe>
std::vector<Band> bands(const RunRecord& record, const Code& code, const Describe& describe) {
  std::vector<Band> all;
  const std::vector<EstimateRow>& rows = record.estimates;
  for (std::size_t first = 0; first < rows.size();) {
    std::size_t next = first + 1;
    while (next < rows.size() && code(rows[next]) == code(rows[first])) ++next;
    Band band = describe(code(rows[first]));
    band.start_h = hours(rows[first].time_s);
    band.end_h = hours(rows[std::min(next, rows.size() - 1)].time_s);
    if (!band.text.empty()) all.push_back(std::move(band));
    first = next;
  }
  return all;
}

Band warning_unless_ok(int status) {
  Band band{.colour = kWarningColour};
  const bool tried = status != telemetry_control::kStatusNotReady;  // it was asked
  if (tried && status != telemetry_control::kStatusOk) band.text = status_name(status);
  return band;
}

std::string what_was_done_when(const RunRecord& record) {
  std::vector<TimelineRow> rows{
      {"mode", bands(
                   record, [](const EstimateRow& r) { return r.mode; },
                   [](int mode) {
                     return Band{.colour = mode == mode_command::kModeApproach ? 0
                                           : mode == mode_command::kModeHold   ? 6
                                                                               : 5,
                                 .text = mode_name(mode)};
                   })},
      {"next waypoint",
       bands(
           record, [](const EstimateRow& r) { return r.waypoint_index; },
           [](int index) { return Band{.colour = 5, .text = index < 0 ? "" : std::to_string(index)}; })},
      {"plan by", bands(
                      record, [](const EstimateRow& r) { return r.active_solver; },
                      [](int solver) {
                        return Band{.colour = std::clamp(solver, 0, 5), .text = solver < 0 ? "" : solver_name(solver)};
                      })}};
  for (const int solver : solvers()) {
    const std::size_t place = place_of_status(solver);
    if (place == kSolverStatuses) continue;
    rows.push_back({solver_name(solver),
                    bands(
                        record, [&](const EstimateRow& r) { return r.solver_status[place]; }, warning_unless_ok)});
  }
  rows.push_back(
      {"passive safety", bands(
                             record, [](const EstimateRow& r) { return r.safety_status; }, warning_unless_ok)});
  return "<p class=\"note\">The rows of the solvers and of passive safety show status codes other than ok.</p>\n" +
         figures(1, {timeline(rows, hours_of(whole_run(record)))});
}

Plot distance_plot(const RunRecord& record) {
  const View whole = whole_run(record);
  Plot plot = time_plot(whole, "Distance to the target, and the minimum if the plan stopped after any of its maneuvers",
                        "distance", Unit::kMetres, 280.0);
  plot.y.logarithmic = true;
  plot.series = {
      {"true distance", 0, Mark::kLine,
       over_time(record.truth, whole, [](const TruthRow& r) { return magnitude(r.relative_position_rtn); })},
      {"passive safety distance", 1, Mark::kLine,
       over_time(record.estimates, whole, [](const EstimateRow& r) { return r.passive_safety_distance_m; })}};
  return plot;
}

}  // namespace

Section guidance_section(const RunRecord& record) {
  if (record.estimates.empty() || record.truth.empty()) return {};
  return {"Guidance and passive safety",
          what_was_done_when(record) + plot_rows(1, {distance_plot(record)}),
          {"estimate.csv", "truth.csv"}};
}

}  // namespace vbar::report
