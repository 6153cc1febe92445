#pragma once
// Telecommands that all measurement sources have in common, validated and converted to settings of the relative
// navigation filter.

#include <optional>

#include "fsw/filter/relative_navigation_filter.h"
#include "fsw/messaging/telecommands.h"
#include "fsw/packets/messages.h"

namespace vbar::fsw::navigation {

/// Accepts known sources, ideal navigation without any other, and process noise within its limits.
[[nodiscard]] bool is_valid(const navigation_configuration& configuration);
[[nodiscard]] bool is_valid(const earth_configuration& configuration);
[[nodiscard]] bool is_valid(const thruster_configuration& configuration);
/// Accepts a bound orbit, or ROE within the domain of their model, with positive standard deviations.
[[nodiscard]] bool is_valid(const target_apriori& apriori);

/// Returns the settings by the telecommands in force, with default values for those not received.
[[nodiscard]] filter::FilterSettings filter_settings(const messaging::Telecommands& telecommands);
/// Returns the a-priori orbit; `time` is its epoch.
[[nodiscard]] filter::TargetApriori apriori_of(const target_apriori& known, GpsTime time);

}  // namespace vbar::fsw::navigation
