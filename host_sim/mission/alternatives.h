#pragma once
// Keys that exclude each other, where a mission extends another one or is changed by --set.

#include <string_view>

#include <toml++/toml.h>

namespace vbar::mission {

/// Removes from a table in which `key` is about to be stated the keys that it replaces: elements, relative and
/// orbit_file (with orbit_object) replace each other in the orbit of a spacecraft, waypoint and a_roe_m in a relative
/// orbit.
void drop_alternatives(toml::table& table, std::string_view key);

}  // namespace vbar::mission
