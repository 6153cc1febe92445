#pragma once
// Interpolation between the states of a track.

#include <optional>

#include "host_sim/orbit_files/orbit_file.h"

namespace vbar::orbit_files {

/// The state at a time between the first and the last of the track; nothing in a gap or where there are too few.
[[nodiscard]] std::optional<fsw::orbit::CartesianState> interpolated(const Track& track, fsw::GpsTime time);

}  // namespace vbar::orbit_files
