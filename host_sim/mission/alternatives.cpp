#include "host_sim/mission/alternatives.h"

#include <algorithm>
#include <array>
#include <span>

namespace vbar::mission {
namespace {

constexpr std::array<std::string_view, 3> kOrbit{"elements", "relative", "orbit_file"};
constexpr std::array<std::string_view, 2> kRelativeOrbit{"waypoint", "a_roe_m"};
constexpr std::array<std::span<const std::string_view>, 2> kAlternatives{kOrbit, kRelativeOrbit};

}  // namespace

void drop_alternatives(toml::table& table, std::string_view key) {
  for (const std::span<const std::string_view> alternatives : kAlternatives) {
    if (std::ranges::find(alternatives, key) == alternatives.end()) continue;
    for (const std::string_view other : alternatives)
      if (other != key) table.erase(other);
    if (key != "orbit_file" && alternatives.data() == kOrbit.data()) table.erase("orbit_object");
  }
}

}  // namespace vbar::mission
