#include "host_sim/report/waypoint_table.h"

#include <optional>

#include <fmt/format.h>

#include "host_sim/report/loop_name.h"
#include "host_sim/report/mission_views.h"
#include "host_sim/report/number_text.h"

namespace vbar::report {
namespace {

std::optional<double> millimetres(const std::optional<double>& metres) {
  return metres ? std::optional(1e3 * *metres) : std::nullopt;
}

}  // namespace

std::string waypoint_table(const RunRecord& record) {
  constexpr auto kHead = "{:>8} {:>9} {:>14} {:>17} {:>17} {:>12} {:>12} {:>10}\n";
  std::string text;
  for (const std::string& testbed : emulated_testbeds(record.summary))
    text += fmt::format("figures of an emulated bench: the testbed {} was emulated\n", testbed);
  text +=
      fmt::format(kHead, "", "time", "control error", "navigation error", "velocity error", "leg dv", "total dv", "");
  text += fmt::format(kHead, "waypoint", "h", "m", "m", "mm/s", "m/s", "m/s", "maneuvers");
  for (const WaypointRow& row : record.waypoints) {
    const bool is_first = is_start(record, row);
    const std::optional<double> control_error_m = is_first ? std::nullopt : std::optional(row.control_error_m);
    text += fmt::format("{:>8} {:>9.3f} {:>14} {:>17} {:>17} {:>12.6f} {:>12.6f} {:>10}\n",
                        is_first ? fmt::format("start {}", row.index) : std::to_string(row.index), row.time_s / 3600.0,
                        fixed(control_error_m, 4), fixed(row.navigation_error_m, 4),
                        fixed(millimetres(row.navigation_velocity_error_mps), 4), row.leg_dv_mps, row.cumulative_dv_mps,
                        row.leg_maneuvers);
  }
  const Summary& s = record.summary;
  text += fmt::format("{:>8} {:>9.3f} {:>14} {:>17} {:>17} {:>12} {:>12.6f} {:>10}\n", s.complete ? "all" : "stopped",
                      s.simulated_s / 3600.0, "", "", "", "", s.dv_mps, s.maneuvers);
  return text;
}

}  // namespace vbar::report
