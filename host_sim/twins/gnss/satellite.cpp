#include "host_sim/twins/gnss/satellite.h"

#include <fmt/format.h>

namespace vbar::twins::gnss {

std::string name_of(SatelliteId satellite) {
  constexpr std::array<char, kSystems> kLetters{'G', 'E', 'C'};
  return fmt::format("{}{:02d}", kLetters[static_cast<std::size_t>(satellite.system)], satellite.prn);
}

}  // namespace vbar::twins::gnss
