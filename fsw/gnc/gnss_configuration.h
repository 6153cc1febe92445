#pragma once
// The telecommand of GNSS navigation, validated and converted to settings.

#include "fsw/core/result.h"
#include "fsw/packets/messages.h"
#include "fsw/sources/carrier_pair/carrier_aiding.h"
#include "fsw/trunk/trunk.h"

namespace vbar::fsw::gnc {

/// Whether a filter can operate with the values.
[[nodiscard]] bool is_valid(const navigation_configuration& configuration);

/// Navigation by the receivers of both spacecraft: the source, and the blocks of the trunk that it tunes. kOutOfRange
/// for an invalid telecommand.
struct CarrierNavigationSettings {
  sources::CarrierSettings carrier;
  Duration pair_wait;
  trunk::TrunkSettings blocks;
};
Result<CarrierNavigationSettings> carrier_settings(const navigation_configuration& configuration);

}  // namespace vbar::fsw::gnc
