#include "fsw/gnc/outbox.h"

namespace vbar::fsw::gnc {

std::size_t Outbox::sequence_slot(packets::Apid apid) {
  using packets::Apid;
  switch (apid) {
    case Apid::kManeuverCommand:
      return 1;
    case Apid::kTelemetryNavigation:
      return 2;
    case Apid::kTelemetryControl:
      return 3;
    case Apid::kTelemetryGnss:
      return 4;
    case Apid::kPointingCommand:
      return 5;
    case Apid::kTelemetryImage:
      return 6;
    case Apid::kTelemetryObjects:
      return 7;
    case Apid::kTelemetryPose:
      return 8;
    case Apid::kTelemetryHealth:
    case Apid::kTick:
    case Apid::kIdealNavigation:
    case Apid::kGnssBytes:
    case Apid::kCrosslinkGnssBytes:
    case Apid::kAttitude:
    case Apid::kCrosslinkAttitude:
    case Apid::kImageTile:
    case Apid::kRangeMeasurement:
    case Apid::kExecutedManeuver:
    case Apid::kWaypointTable:
    case Apid::kGncConfiguration:
    case Apid::kModeCommand:
    case Apid::kNavigationConfiguration:
    case Apid::kCameraConfiguration:
    case Apid::kAnglesOnlyConfiguration:
    case Apid::kTargetApriori:
    case Apid::kPoseConfiguration:
    case Apid::kStepReport:
    case Apid::kWiredBytes:
      break;
  }
  return 0;
}

}  // namespace vbar::fsw::gnc
