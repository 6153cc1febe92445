#pragma once
// Telecommands that bring a flight under way from one version of its mission to another.

#include <vector>

#include "fsw/core/gps_time.h"
#include "host_sim/twins/packet_source.h"

namespace vbar::app {

/// Returns the telecommands of `wanted` whose content is not among `sent`, dated `time`. Throws std::runtime_error for
/// one that sets up the flight software before its first step (all but guidance, waypoints, safety and mode), and for
/// one that was sent and cannot be revoked.
[[nodiscard]] std::vector<twins::Packet> changed_telecommands(const std::vector<twins::Packet>& sent,
                                                              const std::vector<twins::Packet>& wanted,
                                                              fsw::GpsTime time);

}  // namespace vbar::app
