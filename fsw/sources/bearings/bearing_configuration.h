#pragma once
// The telecommand of bearings, validated and converted to settings.

#include "fsw/angles_only/angles_only_tracking.h"
#include "fsw/core/result.h"
#include "fsw/packets/messages.h"
#include "fsw/sources/bearings/bearing_aiding.h"

namespace vbar::fsw::sources {

[[nodiscard]] bool is_valid(const angles_only_configuration& configuration);

/// kOutOfRange for an invalid telecommand, here and below.
Result<angles_only::CameraSettings> camera_settings(const camera_configuration& camera,
                                                    const angles_only_configuration& angles_only);
Result<BearingSettings> bearing_settings(const angles_only_configuration& angles_only);

}  // namespace vbar::fsw::sources
