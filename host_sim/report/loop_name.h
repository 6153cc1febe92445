#pragma once
// Name of the loop of a run: software, processor or hardware in the loop.

#include <string>
#include <vector>

#include "host_sim/report/summary.h"

namespace vbar::report {

/// "SIL, in process", "PIL, emulated Zynq", "HIL, emulated bench", "HIL, hardware bench, board".
[[nodiscard]] std::string loop_name(const Summary& summary);

/// Names of the testbeds of the run that were emulated.
[[nodiscard]] std::vector<std::string> emulated_testbeds(const Summary& summary);

}  // namespace vbar::report
