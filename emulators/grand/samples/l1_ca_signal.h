#pragma once
// C/A code of GPS (IS-GPS-200N 3.3.2.3, table 3-Ia).

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "host_sim/twins/gnss/constellation.h"
#include "host_sim/twins/gnss/navigation_message.h"

namespace vbar::grand::bench {

inline constexpr int kCaCodeChips = 1023;
inline constexpr double kCaCodeChipRate_hz = 1.023e6;
inline constexpr int kCaCodes = 32;

/// Period of the code, chips of 0 and 1.
using CaCode = std::array<std::uint8_t, kCaCodeChips>;

/// Returns the code of a satellite. Throws std::out_of_range unless prn is 1 to 32.
const CaCode& ca_code(int prn);

// Bits of the GPS navigation message, by the time at which they are transmitted.
//
// A frame is 30 s: subframes 1 to 3 with the satellite's broadcast set, page 18 (ionosphere and UTC) in every subframe
// 4, a page without content in every subframe 5. The 25 pages of a real master frame are not cycled: page 18 would come
// once in 12.5 minutes, and almanacs are not needed by a receiver that searches all satellites.

class LnavBits {
 public:
  static constexpr std::int64_t kBit_ms = 20;
  static constexpr std::int64_t kSubframe_ms = 6000;

  /// `constellation` must not be null.
  explicit LnavBits(std::shared_ptr<const twins::gnss::Constellation> constellation);

  /// Returns the bit that `satellite` transmits at `time_ms` of its own time, ms of GPS time since 1980. Throws
  /// std::out_of_range for a satellite that the constellation does not have or a number that does not fit the message.
  [[nodiscard]] bool bit(twins::gnss::SatelliteId satellite, std::int64_t time_ms);

  /// Returns subframe number `number` since 1980, each 6 s, of the same clock.
  [[nodiscard]] const twins::gnss::TransmittedSubframe& subframe(twins::gnss::SatelliteId satellite,
                                                                 std::int64_t number);

 private:
  // Subframes with even and with odd numbers that were used last.
  struct Cached {
    std::int64_t number = -1;
    twins::gnss::TransmittedSubframe words{};
  };
  struct Satellite {
    std::size_t index = 0;  ///< index in the constellation
    bool present = false;
    std::array<Cached, 2> cached;
  };
  Satellite& entry(twins::gnss::SatelliteId satellite);
  [[nodiscard]] twins::gnss::Subframe content(std::size_t index, std::int64_t number) const;

  std::shared_ptr<const twins::gnss::Constellation> constellation_;
  std::vector<Satellite> satellites_;  ///< by number of the GPS satellite
};

}  // namespace vbar::grand::bench
