#pragma once
// What a mission telecommands to its flight software at the start, as messages of the packet contract.

#include "fsw/packets/messages.h"
#include "host_sim/mission/mission.h"
#include "host_sim/truth/earth/earth_orientation.h"

namespace vbar::mission {

/// All waypoints of the mission; those that are past at the start are in it too, and the flight software passes over
/// them. A mission has at most kMaxWaypoints of them (the loader sees to it).
[[nodiscard]] vbar::waypoint_table waypoint_table_of(const Mission& mission);

[[nodiscard]] vbar::gnc_configuration gnc_configuration_of(const Mission& mission);

/// For a spacecraft that navigates by GNSS or camera. `orientation`: the Earth's at the start, as the ground predicts
/// it. Antennas are the nominal ones of the spacecraft that flies and its GNSS partner, if it has one.
[[nodiscard]] vbar::navigation_configuration navigation_configuration_of(
    const Mission& mission, const Spacecraft& servicer, const truth::EarthOrientationSeries& orientation);

/// `servicer` must have a camera, as calibrated on the ground: without error.
[[nodiscard]] vbar::camera_configuration camera_configuration_of(const Spacecraft& servicer);

[[nodiscard]] vbar::angles_only_configuration angles_only_configuration_of(const Mission& mission);

/// The target that `servicer`'s camera looks at, as the ground knows it: keypoints of its model, inertia of its body.
/// Throws MissionError for files that cannot be read.
[[nodiscard]] vbar::pose_configuration pose_configuration_of(const Mission& mission, const Spacecraft& servicer);

/// Where navigation before the mission left the target, out of the true states of both at the start: mean ROE off by
/// what the seed draws with the mission's sigmas; nothing without those. Throws std::runtime_error for states that are
/// no orbits.
void add_apriori(const Mission& mission, const Spacecraft& servicer, const fsw::orbit::CartesianState& servicer_state,
                 const fsw::orbit::CartesianState& target_state, vbar::pose_configuration& configuration);

/// Where the ground last knew the target to be, out of the true states of both at the start: mean ROE off by what the
/// seed draws with the mission's sigmas. Throws std::runtime_error for states that are no orbits.
[[nodiscard]] vbar::target_apriori target_apriori_of(const Mission& mission, const Spacecraft& servicer,
                                                     const fsw::orbit::CartesianState& servicer_state,
                                                     const fsw::orbit::CartesianState& target_state);

[[nodiscard]] vbar::mode_command mode_command_of(const Mission& mission);

}  // namespace vbar::mission
