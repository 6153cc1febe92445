#pragma once
// Keys that exclude each other, where a mission extends another one or is changed by --set.

#include <string_view>

#include <toml++/toml.h>

namespace vbar::mission {

/// A table in which `key` is about to be stated loses the keys that it takes the place of: of the orbit of a spacecraft
/// elements, relative and orbit_file (with orbit_object), of a relative orbit waypoint and a_roe_m.
void drop_alternatives(toml::table& table, std::string_view key);

}  // namespace vbar::mission
