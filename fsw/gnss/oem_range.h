#pragma once
// The observations of a NovAtel receiver: logs RANGE and RANGECMP (OEM7 Commands and Logs Reference Manual).

#include <cstdint>
#include <optional>

#include "fsw/core/result.h"
#include "fsw/gnss/observation.h"
#include "fsw/gnss/oem_stream.h"

namespace vbar::fsw::gnss {

// The channel tracking status of a NovAtel receiver, one word for each tracked signal (OEM7 Commands and Logs Reference
// Manual, log RANGE, table "Channel tracking status").

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

inline constexpr std::uint16_t kOemRange = 43;
inline constexpr std::uint16_t kOemRangeCompressed = 140;

/// Counts of the signals that are not in the epoch.
struct ObservationTally {
  std::uint32_t not_used = 0;       ///< signals and systems not used on board, or unknown satellite
  std::uint32_t not_locked = 0;     ///< no code lock: no pseudorange
  std::uint32_t implausible = 0;    ///< NaN, or outside the range of a satellite signal
  std::uint32_t phase_refused = 0;  ///< phases that are NaN or out of range; the observation is kept for its code
  std::uint32_t duplicate = 0;      ///< the same satellite and signal again, or by a code of lower rank
  std::uint32_t no_room = 0;        ///< more than kMaxObservations
};

/// Reads RANGE (id 43) into `epoch`; `tally` is added to. On any status but kOk `epoch` is empty: kWrongType for
/// another id; kTooShort for a body shorter than announced; that of time_of() for its time. Signals that are not usable
/// are left out, one by one.
Status read_range(const OemMessage& message, ObservationEpoch& epoch, ObservationTally& tally);

/// Reads RANGECMP (id 140) in the same way; its carrier phase rolls over and is corrected by the pseudorange.
Status read_range_compressed(const OemMessage& message, ObservationEpoch& epoch, ObservationTally& tally);

}  // namespace vbar::fsw::gnss
