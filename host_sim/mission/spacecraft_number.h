#pragma once
// Numbers of spacecraft in packet headers, mission::Spacecraft::number.

#include <cstdint>

namespace vbar::mission {

inline constexpr int kMaxSpacecraftNumber = 255;

/// Number of a spacecraft beyond that range. It has neither flight computer nor sensors.
inline constexpr std::uint8_t kNoSpacecraftNumber = 0;

}  // namespace vbar::mission
