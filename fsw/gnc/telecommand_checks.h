#pragma once
// The rules of all telecommands: whether the values of one are within their valid ranges, and whether several agree. A
// new telecommand needs its is_valid: the rules do not compile without it.

#include "fsw/messaging/telecommands.h"
#include "fsw/packets/messages.h"

namespace vbar::fsw::gnc {

// The checks of navigation are beside their conversion: filter_configuration.h, and the rooms of fsw/measurements.

/// Accepts one to sixteen waypoints in order of time, within the domain of the relative-orbit models.
[[nodiscard]] bool is_valid(const waypoint_table& table);
[[nodiscard]] bool is_valid(const gnc_configuration& configuration);
[[nodiscard]] bool is_valid(const mode_command& command);
[[nodiscard]] bool is_valid(const safety_configuration& configuration);
[[nodiscard]] bool is_valid(const fault_command& command);

/// Returns the rules that the flight software passes to its store of telecommands.
[[nodiscard]] const messaging::TelecommandRules& telecommand_rules();

}  // namespace vbar::fsw::gnc
