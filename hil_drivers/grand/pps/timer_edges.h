#pragma once
// Edges every second of the host's own clock, for a testbed without a PPS line.

#include "hil_drivers/grand/pps/edge_source.h"

namespace vbar::grand {

extern const EdgeSourceKind kTimerEdges;  ///< "timer"

}  // namespace vbar::grand
