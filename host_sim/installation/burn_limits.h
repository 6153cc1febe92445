#pragma once
// What guidance must know of a thruster whose burns have a duration: the smallest and the largest burn, and how long
// before its centre a burn must be commanded.

#include <string>

#include "host_sim/mission/mission.h"

namespace vbar::sensors {

/// Restricts burns to those that the thruster of a spacecraft can execute, and lengthens the time before a burn by half
/// of the longest one; with impulses nothing changes. Throws std::runtime_error if no burn is left.
void limit_burns(const mission::Spacecraft& servicer, vbar::gnc_configuration& configuration);

/// Returns the telecommand of navigation's uncertainty of burns with the thruster of the spacecraft: with impulses that
/// of the mission. Throws std::runtime_error for a thrust that the flight software does not accept.
[[nodiscard]] vbar::thruster_configuration thruster_configuration_of(const mission::Mission& mission,
                                                                     const mission::Spacecraft& servicer);

/// Returns a sentence on these limits; empty with impulses.
[[nodiscard]] std::string note_on_burns(const mission::Spacecraft& servicer, const vbar::gnc_configuration& stated);

}  // namespace vbar::sensors
