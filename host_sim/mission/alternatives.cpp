#include "host_sim/mission/alternatives.h"

#include <array>

namespace vbar::mission {
namespace {

struct Replacement {
  std::string_view key;
  std::array<std::string_view, 3> replaced;
};
constexpr std::array<Replacement, 5> kReplacements{{{"elements", {"relative", "orbit_file", "orbit_object"}},
                                                    {"relative", {"elements", "orbit_file", "orbit_object"}},
                                                    {"orbit_file", {"elements", "relative"}},
                                                    {"waypoint", {"a_roe_m"}},
                                                    {"a_roe_m", {"waypoint"}}}};

}  // namespace

void drop_alternatives(toml::table& table, std::string_view key) {
  for (const Replacement& replacement : kReplacements) {
    if (replacement.key != key) continue;
    for (const std::string_view other : replacement.replaced)
      if (!other.empty()) table.erase(other);
  }
}

}  // namespace vbar::mission
