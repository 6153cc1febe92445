#pragma once
// Telecommands to navigation that no single sensor determines: its sources, the Earth, burns and the a-priori orbit.

#include <cstdint>
#include <string>

#include "host_sim/mission/mission.h"
#include "host_sim/sensors/sensor_kind.h"

namespace vbar::sensors {

/// Returns the sources that navigation of the spacecraft uses, a sum of navigation_configuration::kUse: true states
/// alone, or all that its sensors offer.
[[nodiscard]] std::int32_t sources_of(const mission::Spacecraft& servicer);

[[nodiscard]] vbar::navigation_configuration navigation_configuration_of(const mission::Mission& mission,
                                                                         const mission::Spacecraft& servicer);

/// Returns the telecommand of the Earth. `orientation`: the Earth's at the start, as the ground predicts it.
[[nodiscard]] vbar::earth_configuration earth_configuration_of(const mission::Mission& mission,
                                                               const truth::EarthOrientationSeries& orientation);

/// Returns the a-priori orbit of the target, as the ground or preceding navigation has it, from the true states of both
/// at the start: mean ROE with errors drawn by the seed with the mission's sigmas. Throws std::runtime_error for states
/// that are not orbits.
[[nodiscard]] vbar::target_apriori target_apriori_of(const mission::Mission& mission,
                                                     const mission::Spacecraft& servicer,
                                                     const fsw::orbit::CartesianState& servicer_state,
                                                     const fsw::orbit::CartesianState& target_state);

/// Adds the telecommands to navigation; none with ideal navigation, which needs none.
void add_navigation_telecommands(const TelecommandContext& context, Telecommands& telecommands);

// What guidance must know of a thruster whose burns have a duration: the smallest and the largest burn, and how long
// before its centre a burn must be commanded.

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
