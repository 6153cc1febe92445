#pragma once
// The observations of a NovAtel receiver: logs RANGE and RANGECMP (OEM7 Commands and Logs Reference Manual).

#include "fsw/core/result.h"
#include "fsw/gnss/observation.h"
#include "fsw/gnss/oem_stream.h"

namespace vbar::fsw::gnss {

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
