#pragma once
// The time in the header of a NovAtel message (OEM7 Commands and Logs Reference Manual, 1.2 "GPS reference time
// status").

#include "fsw/core/gps_time.h"
#include "fsw/core/result.h"
#include "fsw/gnss/oem_stream.h"

namespace vbar::fsw::gnss {

/// The receiver's status of GPS time.
enum class OemTimeStatus : std::uint8_t {
  kUnknown = 20,
  kApproximate = 60,
  kCoarseAdjusting = 80,
  kCoarse = 100,
  kCoarseSteering = 120,
  kFreewheeling = 130,
  kFineAdjusting = 140,
  kFine = 160,
  kFineBackupSteering = 170,
  kFineSteering = 180,
  kSatTime = 200,
};

/// Returns the receiver's own time of the message, exact. kNotReady: the receiver does not have the time (unknown,
/// approximate within seconds, or week 0). kOutOfRange: an unknown status, a week after 2171, a time of week beyond a
/// week.
Result<GpsTime> time_of(const OemMessage& message);

}  // namespace vbar::fsw::gnss
