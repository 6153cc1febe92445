#pragma once
// C/A code of GPS (IS-GPS-200N 3.3.2.3, table 3-Ia).

#include <array>
#include <cstdint>

namespace vbar::grand::bench {

inline constexpr int kCaCodeChips = 1023;
inline constexpr double kCaCodeChipRate_hz = 1.023e6;
inline constexpr int kCaCodes = 32;

/// Period of the code, chips of 0 and 1.
using CaCode = std::array<std::uint8_t, kCaCodeChips>;

/// Returns the code of a satellite. Throws std::out_of_range unless prn is 1 to 32.
const CaCode& ca_code(int prn);

}  // namespace vbar::grand::bench
