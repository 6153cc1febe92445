#pragma once
// The telecommand of navigation by GNSS, checked and turned into settings.

#include "fsw/core/result.h"
#include "fsw/navigation/gnss_navigation.h"
#include "fsw/packets/messages.h"

namespace vbar::fsw::gnc {

/// What a telecommand asks for; kOutOfRange for figures that no filter can work with.
Result<navigation::GnssNavigationSettings> gnss_settings(const navigation_configuration& configuration);

}  // namespace vbar::fsw::gnc
