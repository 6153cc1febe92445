#pragma once
// Which messages are packets: the compile-time list, the APID of each, and whether its numbers are finite.
// A new message is a struct in vbar.lcm, an APID in packet.h, a line in VBAR_FOR_EACH_MESSAGE and an overload of
// all_finite.

#include <vbar/angles_only_configuration.hpp>
#include <vbar/attitude.hpp>
#include <vbar/camera_configuration.hpp>
#include <vbar/crosslink_attitude.hpp>
#include <vbar/crosslink_gnss_bytes.hpp>
#include <vbar/executed_maneuver.hpp>
#include <vbar/gnc_configuration.hpp>
#include <vbar/gnss_bytes.hpp>
#include <vbar/ideal_navigation.hpp>
#include <vbar/image_tile.hpp>
#include <vbar/maneuver_command.hpp>
#include <vbar/mode_command.hpp>
#include <vbar/navigation_configuration.hpp>
#include <vbar/pointing_command.hpp>
#include <vbar/pose_configuration.hpp>
#include <vbar/step_report.hpp>
#include <vbar/target_apriori.hpp>
#include <vbar/telemetry_control.hpp>
#include <vbar/telemetry_gnss.hpp>
#include <vbar/telemetry_health.hpp>
#include <vbar/telemetry_image.hpp>
#include <vbar/telemetry_navigation.hpp>
#include <vbar/telemetry_objects.hpp>
#include <vbar/telemetry_pose.hpp>
#include <vbar/tick.hpp>
#include <vbar/waypoint_table.hpp>

#include "fsw/packets/packet.h"

/// Expands X(message type, Apid enumerator) for every message that travels as a packet.
#define VBAR_FOR_EACH_MESSAGE(X)                                 \
  X(::vbar::tick, kTick)                                         \
  X(::vbar::ideal_navigation, kIdealNavigation)                  \
  X(::vbar::gnss_bytes, kGnssBytes)                              \
  X(::vbar::crosslink_gnss_bytes, kCrosslinkGnssBytes)           \
  X(::vbar::attitude, kAttitude)                                 \
  X(::vbar::crosslink_attitude, kCrosslinkAttitude)              \
  X(::vbar::image_tile, kImageTile)                              \
  X(::vbar::executed_maneuver, kExecutedManeuver)                \
  X(::vbar::waypoint_table, kWaypointTable)                      \
  X(::vbar::gnc_configuration, kGncConfiguration)                \
  X(::vbar::mode_command, kModeCommand)                          \
  X(::vbar::navigation_configuration, kNavigationConfiguration)  \
  X(::vbar::camera_configuration, kCameraConfiguration)          \
  X(::vbar::angles_only_configuration, kAnglesOnlyConfiguration) \
  X(::vbar::target_apriori, kTargetApriori)                      \
  X(::vbar::pose_configuration, kPoseConfiguration)              \
  X(::vbar::maneuver_command, kManeuverCommand)                  \
  X(::vbar::pointing_command, kPointingCommand)                  \
  X(::vbar::telemetry_navigation, kTelemetryNavigation)          \
  X(::vbar::telemetry_control, kTelemetryControl)                \
  X(::vbar::telemetry_health, kTelemetryHealth)                  \
  X(::vbar::telemetry_gnss, kTelemetryGnss)                      \
  X(::vbar::telemetry_image, kTelemetryImage)                    \
  X(::vbar::telemetry_objects, kTelemetryObjects)                \
  X(::vbar::telemetry_pose, kTelemetryPose)                      \
  X(::vbar::step_report, kStepReport)

namespace vbar::fsw::packets {

/// MessageTraits<M>::kApid for every message that is a packet; undefined for any other type.
template <class Message>
struct MessageTraits;

#define VBAR_MESSAGE(type, enumerator)                              \
  template <>                                                       \
  struct MessageTraits<type> {                                      \
    static constexpr Apid kApid = Apid::enumerator;                 \
  };                                                                \
  /** False if any floating-point field is a NaN or an infinity. */ \
  [[nodiscard]] bool all_finite(const type& message);
VBAR_FOR_EACH_MESSAGE(VBAR_MESSAGE)
#undef VBAR_MESSAGE

/// Calls visit.template operator()<Message>() for every message that is a packet.
template <class Visitor>
constexpr void for_each_message(Visitor&& visit) {
#define VBAR_MESSAGE(type, enumerator) visit.template operator()<type>();
  VBAR_FOR_EACH_MESSAGE(VBAR_MESSAGE)
#undef VBAR_MESSAGE
}

/// The message's name as vbar.lcm has it (also its LCM type name); null for an APID that carries none.
[[nodiscard]] const char* message_name(Apid apid);

}  // namespace vbar::fsw::packets
