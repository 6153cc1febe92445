#pragma once
// Consistency of navigation over a run and at selected times, for campaigns.

#include <string>
#include <vector>

#include "host_sim/report/run_record.h"

namespace vbar::report {

/// Dimension of the NEES, mean NIS and its dimension, and the samples at the times that `summary.samples` names: of the
/// estimates and of the figures that the extensions give. A sample without an estimate at its time has no errors; the
/// consistency figures of a sample are the last ones after the previous sample, so that no figure serves two samples.
void summarise_consistency(const RunRecord& record, Summary& summary);

// The figures of a run, computed from its tables.

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
