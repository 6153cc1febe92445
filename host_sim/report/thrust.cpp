#include "host_sim/report/thrust.h"

#include <cstddef>
#include <vector>

#include <fmt/format.h>

#include "host_sim/report/maneuver_series.h"

namespace vbar::report {
namespace {

/// A burn of the mission file or of a fault takes effect when it is announced.
bool is_commanded(const ManeuverRow& row) {
  return row.waypoint_index >= 0 || row.command_time_s < row.execution_time_s;
}

}  // namespace

void summarise_thrust(const RunRecord& record, Summary& summary) {
  if (!summary.thrust) return;
  Thrust& thrust = *summary.thrust;
  thrust = {.max_thrust_n = thrust.max_thrust_n, .mass_kg = thrust.mass_kg};
  std::vector<ManeuverRow> burns;
  for (const ManeuverRow& row : executed_in_order(record))
    if (is_commanded(row)) burns.push_back(row);
  thrust.burns = static_cast<int>(burns.size());
  for (std::size_t k = 0; k < burns.size(); ++k) {
    const double duration_s = thrust.mass_kg * magnitude(burns[k].executed_dv_rtn_mps) / thrust.max_thrust_n;
    if (duration_s > thrust.longest_burn_s) {
      thrust.longest_burn_s = duration_s;
      thrust.longest_burn_at_h = burns[k].execution_time_s / 3600.0;
    }
    const bool has_next = k + 1 < burns.size();
    if (has_next && duration_s > burns[k + 1].execution_time_s - burns[k].execution_time_s) ++thrust.burns_too_long;
  }
}

std::string thrust_line(const Summary& summary) {
  if (!summary.thrust || summary.thrust->burns == 0) return "";
  const Thrust& thrust = *summary.thrust;
  return fmt::format(
      "thrust: {} of {} burns would last longer than the time to the next burn at {:g} N and {:g} kg; the longest, at "
      "{:.3f} h, {:.3g} s; burns are flown as impulses",
      thrust.burns_too_long, thrust.burns, thrust.max_thrust_n, thrust.mass_kg, thrust.longest_burn_at_h,
      thrust.longest_burn_s);
}

}  // namespace vbar::report
