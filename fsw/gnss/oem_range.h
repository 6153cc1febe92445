#pragma once
// The observations of a NovAtel receiver: logs RANGE and RANGECMP (OEM7 Commands and Logs Reference Manual).

#include "fsw/core/result.h"
#include "fsw/gnss/observation.h"
#include "fsw/gnss/oem_stream.h"

namespace vbar::fsw::gnss {

inline constexpr std::uint16_t kOemRange = 43;
inline constexpr std::uint16_t kOemRangeCompressed = 140;

/// What became of the signals of an epoch that it does not hold.
struct ObservationTally {
  std::uint32_t not_used = 0;       ///< signals and systems that are not used on board, or no such satellite
  std::uint32_t not_locked = 0;     ///< no code lock: no pseudorange
  std::uint32_t implausible = 0;    ///< not a number, or out of the range of what a satellite can give
  std::uint32_t phase_refused = 0;  ///< kept for its code; its phase is not a number or out of range
  std::uint32_t duplicate = 0;      ///< the same satellite and signal again, or by a code of lower rank
  std::uint32_t no_room = 0;        ///< beyond kMaxObservations
};

/// Reads RANGE (id 43) into `epoch`; `tally` is added to. On any status but kOk `epoch` is empty: kWrongType for
/// another id; kTooShort for a body with less than it announces; time_of()'s for its time. Signals that are not usable
/// are left out, one by one.
Status read_range(const OemMessage& message, ObservationEpoch& epoch, ObservationTally& tally);

/// The same for RANGECMP (id 140), whose carrier phase has rolled over and is put right by the pseudorange.
Status read_range_compressed(const OemMessage& message, ObservationEpoch& epoch, ObservationTally& tally);

}  // namespace vbar::fsw::gnss
