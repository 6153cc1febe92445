#pragma once
// `--set path=value`: a key of a mission file, given on the command line.

#include <string>

#include <toml++/toml.h>

namespace vbar::mission {

/// Sets `assignment` ("path=value") in the document, in place of the value of the file; the checks follow and are the
/// same as for the file. The value is TOML, or failing that a text without quotes.
///
/// A path is dotted: mission.seed, spacecraft.servicer.flight_computer.target (by the spacecraft's name),
/// waypoint.3.time_h (by the waypoint's index), fault.outage.at_h (by its name), vehicle.target.com_ports (of a bench's
/// scenario). An array of tables is replaced as a whole: fault=[{kind="silent", ...}]. flight_computer, and
/// the name of a sensor of the servicer need no spacecraft before them: camera.period_s is
/// spacecraft.servicer.sensors.camera.period_s.
///
/// Throws MissionError, whose location is the override, for an invalid assignment and for an unknown spacecraft or
/// waypoint.
void apply_override(toml::table& document, const std::string& assignment);

}  // namespace vbar::mission
