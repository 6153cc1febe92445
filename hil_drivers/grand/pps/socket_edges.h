#pragma once
// Edges that the emulator announces on a Unix datagram socket (../wire/pps_datagram.h).

#include "hil_drivers/grand/pps/edge_source.h"

namespace vbar::grand {

extern const EdgeSourceKind kSocketEdges;  ///< "socket:/run/bench/pps.sock"

}  // namespace vbar::grand
