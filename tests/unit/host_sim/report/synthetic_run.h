#pragma once
// A made-up run of the paper's waypoints, plausible to look at, with something in every column: a report must cope with
// noise, refused burns, solvers that failed and steps without a valid estimate.

#include "host_sim/report/run_record.h"
#include "host_sim/sensors/camera/camera_rows.h"
#include "host_sim/sensors/gnss/gnss_row.h"

namespace vbar::report::test {

[[nodiscard]] RunRecord synthetic_run();

}  // namespace vbar::report::test
