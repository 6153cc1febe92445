#include "fsw/gnss/oem_fields.h"

#include "fsw/gnss/gps_week.h"

namespace vbar::fsw::gnss {
namespace {

constexpr std::int64_t kNanosecondsPerMillisecond = 1'000'000;
constexpr std::int64_t kMillisecondsPerWeek = kSecondsPerWeek * 1000;

Status usable(std::uint8_t time_status) {
  switch (static_cast<OemTimeStatus>(time_status)) {
    case OemTimeStatus::kUnknown:
    case OemTimeStatus::kApproximate:
      return Status::kNotReady;
    case OemTimeStatus::kCoarseAdjusting:
    case OemTimeStatus::kCoarse:
    case OemTimeStatus::kCoarseSteering:
    case OemTimeStatus::kFreewheeling:
    case OemTimeStatus::kFineAdjusting:
    case OemTimeStatus::kFine:
    case OemTimeStatus::kFineBackupSteering:
    case OemTimeStatus::kFineSteering:
    case OemTimeStatus::kSatTime:
      return Status::kOk;
  }
  return Status::kOutOfRange;  // an unknown value
}

}  // namespace

Result<GpsTime> time_of(const OemMessage& message) {
  const Status status = usable(message.time_status);
  if (status != Status::kOk) return status;
  if (message.week == 0) return Status::kNotReady;
  if (message.week > kMaxWeek || message.time_of_week_ms >= kMillisecondsPerWeek) return Status::kOutOfRange;
  return start_of_week(message.week) + Duration{message.time_of_week_ms * kNanosecondsPerMillisecond};
}

}  // namespace vbar::fsw::gnss
