#pragma once
// Telecommands of what all sources have in common, validated and converted to settings of the trunk.

#include <optional>

#include "fsw/gnc/telecommands.h"
#include "fsw/packets/messages.h"
#include "fsw/trunk/trunk.h"

namespace vbar::fsw::gnc {

/// Known sources, ideal navigation alone, and process noise within its limits.
[[nodiscard]] bool is_valid(const navigation_configuration& configuration);
[[nodiscard]] bool is_valid(const earth_configuration& configuration);
[[nodiscard]] bool is_valid(const thruster_configuration& configuration);
/// A bound orbit, or ROE within the domain of their model, with positive standard deviations.
[[nodiscard]] bool is_valid(const target_apriori& apriori);

/// From the telecommands in force; default values in place of those not received.
[[nodiscard]] filter::FilterSettings trunk_settings(const Telecommands& telecommands);
/// `time`: its epoch.
[[nodiscard]] filter::TargetApriori apriori_of(const target_apriori& known, GpsTime time);

}  // namespace vbar::fsw::gnc
