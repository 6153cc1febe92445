#pragma once
// Pointing of a camera, and the position of the servicer at the time of an image.

#include <optional>
#include <span>

#include "fsw/core/gps_time.h"
#include "fsw/navigation/burn.h"
#include "fsw/navigation/gnss_navigation.h"
#include "fsw/orbit/elements.h"
#include "fsw/sources/pointing.h"

namespace vbar::fsw::gnc {

using sources::Pointing;
using sources::pointing_at;
using sources::R_body_eci_of;

/// The servicer at `time` by its own receiver, including burns until then; a burn at `time` is included. No value if
/// the estimate has not reached `time` yet, or is ahead of it.
std::optional<orbit::CartesianState> servicer_at(GpsTime time, const navigation::GnssNavigation& own_orbit,
                                                 std::span<const navigation::Burn> burns);

}  // namespace vbar::fsw::gnc
