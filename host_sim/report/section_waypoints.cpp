#include <fmt/format.h>

#include "host_sim/report/html_page.h"
#include "host_sim/report/mission_views.h"
#include "host_sim/report/number_text.h"
#include "host_sim/report/report_sections.h"

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

}  // namespace vbar::report
