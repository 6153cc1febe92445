#pragma once
// The channel tracking status of a NovAtel receiver, one word for each tracked signal (OEM7 Commands and Logs Reference
// Manual, log RANGE, table "Channel tracking status").

#include <cstdint>
#include <optional>

#include "fsw/gnss/observation.h"

namespace vbar::fsw::gnss {

struct TrackingStatus {
  bool phase_lock = false;
  bool parity_known = false;  ///< if false, the carrier phase may be off by half a cycle
  bool code_lock = false;
  std::uint8_t system = 0;  ///< 0 GPS, 1 GLONASS, 2 SBAS, 3 Galileo, 4 BeiDou, ...
  std::uint8_t signal = 0;  ///< the receiver's number for the signal, per system
};

constexpr TrackingStatus tracking_status(std::uint32_t word) {
  return {.phase_lock = (word & (1U << 10U)) != 0,
          .parity_known = (word & (1U << 11U)) != 0,
          .code_lock = (word & (1U << 12U)) != 0,
          .system = static_cast<std::uint8_t>((word >> 16U) & 7U),
          .signal = static_cast<std::uint8_t>((word >> 21U) & 31U)};
}

/// Signal used on board, and the rank of its code if a receiver tracks the same signal by several codes (lower is
/// better). All satellites of GPS send the P code on L2, only the newer ones L2C.
struct UsedSignal {
  Constellation constellation = Constellation::kGps;
  Signal signal = Signal::kGpsL1;
  std::uint8_t code_rank = 0;
};

/// Returns the signal; no value for one not used on board.
constexpr std::optional<UsedSignal> used_signal(const TrackingStatus& status) {
  constexpr std::uint8_t kGps = 0;
  constexpr std::uint8_t kGalileo = 3;
  constexpr std::uint8_t kBeidou = 4;
  if (status.system == kGps) {
    if (status.signal == 0) return UsedSignal{Constellation::kGps, Signal::kGpsL1, 0};   // C/A
    if (status.signal == 9) return UsedSignal{Constellation::kGps, Signal::kGpsL2, 0};   // P(Y), semi-codeless
    if (status.signal == 5) return UsedSignal{Constellation::kGps, Signal::kGpsL2, 1};   // P
    if (status.signal == 17) return UsedSignal{Constellation::kGps, Signal::kGpsL2, 2};  // C(M)
  }
  if (status.system == kGalileo && status.signal == 2) {
    return UsedSignal{Constellation::kGalileo, Signal::kGalileoE1, 0};  // E1C
  }
  if (status.system == kBeidou && (status.signal == 0 || status.signal == 4)) {
    return UsedSignal{Constellation::kBeidou, Signal::kBeidouB1I, 0};  // B1I with message D1, or D2 (geostationary)
  }
  return std::nullopt;
}

/// Returns the highest satellite number of a system's interface document.
constexpr std::uint8_t highest_prn(Constellation constellation) {
  switch (constellation) {
    case Constellation::kGps:
      return 32;
    case Constellation::kGalileo:
      return 36;
    case Constellation::kBeidou:
      return 63;
  }
  return 0;
}

}  // namespace vbar::fsw::gnss
