#pragma once
// Edges that the kernel has time-stamped at a PPS device (RFC 2783).

#include "hil_drivers/grand/pps/edge_source.h"

namespace vbar::grand {

extern const EdgeSourceKind kKernelEdges;  ///< "kernel:/dev/pps0"

}  // namespace vbar::grand
