#include "host_sim/report/waypoint_table.h"

#include <cmath>

#include <fmt/format.h>

namespace vbar::report {
namespace {

std::string error_text(const std::optional<double>& error_m) {
  if (!error_m || !std::isfinite(*error_m)) return "-";
  return fmt::format("{:.4f}", *error_m);
}

std::string velocity_text(const std::optional<double>& error_mps) {
  if (!error_mps || !std::isfinite(*error_mps)) return "-";
  return fmt::format("{:.4f}", *error_mps * 1e3);
}

}  // namespace

std::string waypoint_table(const RunRecord& record) {
  constexpr auto kHead = "{:>8} {:>9} {:>14} {:>17} {:>17} {:>12} {:>12} {:>10}\n";
  std::string text =
      fmt::format(kHead, "", "time", "control error", "navigation error", "velocity error", "leg dv", "total dv", "");
  text += fmt::format(kHead, "waypoint", "h", "m", "m", "mm/s", "m/s", "m/s", "maneuvers");
  for (const WaypointRow& row : record.waypoints) {
    text += fmt::format("{:>8} {:>9.3f} {:>14} {:>17} {:>17} {:>12.6f} {:>12.6f} {:>10}\n", row.index,
                        row.time_s / 3600.0, error_text(row.control_error_m), error_text(row.navigation_error_m),
                        velocity_text(row.navigation_velocity_error_mps), row.leg_dv_mps, row.cumulative_dv_mps,
                        row.leg_maneuvers);
  }
  const Summary& s = record.summary;
  text += fmt::format("{:>8} {:>9.3f} {:>14} {:>17} {:>17} {:>12} {:>12.6f} {:>10}\n", s.complete ? "all" : "stopped",
                      s.simulated_s / 3600.0, "", "", "", "", s.dv_mps, s.maneuvers);
  return text;
}

}  // namespace vbar::report
