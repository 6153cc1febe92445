#pragma once
// The telecommand of GNSS navigation, validated and converted to settings.

#include "fsw/core/result.h"
#include "fsw/navigation/gnss_navigation.h"
#include "fsw/packets/messages.h"

namespace vbar::fsw::gnc {

/// Settings of a telecommand; kOutOfRange for values with which no filter can operate.
Result<navigation::GnssNavigationSettings> gnss_settings(const navigation_configuration& configuration);

}  // namespace vbar::fsw::gnc
