#pragma once
// What guidance must know of a thruster whose burns have a duration: the smallest and the largest burn, and how long
// before its centre a burn must be commanded.

#include <string>

#include "host_sim/mission/mission.h"

namespace vbar::sensors {

/// Restricts burns to those that the thruster of a spacecraft can execute, and lengthens the time before a burn by half
/// of the longest one; with impulses nothing changes. Throws std::runtime_error if no burn is left.
void limit_burns(const mission::Spacecraft& servicer, vbar::gnc_configuration& configuration);

/// Returns a sentence on these limits; empty with impulses.
[[nodiscard]] std::string note_on_burns(const mission::Spacecraft& servicer, const vbar::gnc_configuration& stated);

}  // namespace vbar::sensors
