#pragma once
// Burns against a thrust that the mission states. Burns are flown as impulses; this only reports those that the
// thruster could not deliver.

#include <string>

#include "host_sim/report/run_record.h"

namespace vbar::report {

/// Fills the figures of record.summary.thrust, which holds thrust and mass: a burn of the flight software lasts mass
/// times delta-v over thrust, and does not fit if the next one begins earlier.
void summarise_thrust(const RunRecord& record, Summary& summary);

/// "thrust: 2 of 306 burns would last longer than the time to the next burn at 0.02 N and 30 kg; ..."; empty if the
/// mission states no thrust or nothing was burnt.
[[nodiscard]] std::string thrust_line(const Summary& summary);

}  // namespace vbar::report
