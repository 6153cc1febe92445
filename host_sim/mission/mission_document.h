#pragma once
// Keys that exclude each other, where a mission extends another one or is changed by --set.

#include <filesystem>
#include <string>
#include <string_view>

#include <toml++/toml.h>

namespace vbar::mission {

/// Removes from a table in which `key` is about to be stated the keys that it replaces: elements, relative and
/// orbit_file (with orbit_object) replace each other in the orbit of a spacecraft, waypoint and a_roe_m in a relative
/// orbit.
void drop_alternatives(toml::table& table, std::string_view key);

// `extends = "other.toml"`, or an array of files: a mission file that states only the differences from others.

/// Returns the name of a mission that does not state it: that of its file, in which letters that no name can have
/// become '_'.
[[nodiscard]] std::string name_of_file(const std::filesystem::path& file);

/// Replaces `document`, if it has the key `extends`, by the file that this key names, with `document` put over that
/// file. The name is relative to `file`, or that of a mission of the catalogue; the file may extend another one in
/// turn. If the key names several files, each is put over those before it. Tables are merged key by key, and so are a
/// [[spacecraft]] of the same name and a [[waypoint]] of the same index; other elements of these arrays are appended.
/// Every other value, arrays included, replaces the old one and the keys that it excludes (drop_alternatives). The name
/// of the extended mission is not adopted. Throws MissionError for a file that cannot be read, and for a chain of more
/// than four files.
void put_over_extended(toml::table& document, const std::filesystem::path& file);

/// Returns the text of a file without dependence on others: its own text if it extends nothing, else its merged
/// content, in TOML without comments. Throws MissionError as put_over_extended and for invalid TOML.
[[nodiscard]] std::string whole_mission_text(const std::filesystem::path& file);

// `--set path=value`: a key of a mission file, given on the command line.

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
