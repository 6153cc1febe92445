#pragma once
// The figures of a run, computed from its tables.

#include <string>
#include <vector>

#include "host_sim/report/run_record.h"

namespace vbar::report {

/// The facts of record.summary, and every figure that the tables give. Figures that need a fact which an older version
/// did not write (the target's name) stay as they were.
[[nodiscard]] Summary summarise(const RunRecord& record);

/// Gives each waypoint navigation's error at its time and the delta-v of its leg, then summarises.
void evaluate(RunRecord& record);

/// Returns the counts of the flight software that are not nominal, on one line ("inbox dropped 12, faults inbox_full");
/// empty if there was nothing.
[[nodiscard]] std::string health_line(const telemetry_health& health);

/// "18 of 18 steps returned an error (status 12345), ...", of what is not nominal; empty if all is.
[[nodiscard]] std::string output_line(const Summary& summary);

}  // namespace vbar::report
