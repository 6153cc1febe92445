#pragma once
// `--set path=value`: a key of a mission file, given on the command line.

#include <string>

#include <toml++/toml.h>

namespace vbar::mission {

/// Puts `assignment` ("path=value") into the document, over what the file says; the checks come later and are the same
/// as for the file. The value is TOML, or failing that a text without quotes.
///
/// A path is dotted: mission.seed, spacecraft.servicer.flight_computer.target (by the spacecraft's name),
/// waypoint.3.time_h (by the waypoint's index). flight_computer, and the name of a sensor that the
/// servicer has, need no spacecraft before them: camera.period_s is spacecraft.servicer.sensors.camera.period_s.
///
/// Throws MissionError, whose location is the override, for text that is no assignment and for a spacecraft or waypoint
/// that the file does not have.
void apply_override(toml::table& document, const std::string& assignment);

}  // namespace vbar::mission
