#pragma once
// Which messages are packets: the compile-time list, the APID of each, and whether its numbers are finite.
// A new message is a struct in vbar.lcm, an APID in packet.h and a line in VBAR_FOR_EACH_MESSAGE.

#include <bit>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include <vbar/fields.h>

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
  X(::vbar::range_measurement, kRangeMeasurement)                \
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
  X(::vbar::step_report, kStepReport)                            \
  X(::vbar::wired_bytes, kWiredBytes)

namespace vbar::fsw::packets {

/// MessageTraits<M>::kApid for every message that is a packet; undefined for any other type.
template <class Message>
struct MessageTraits;

#define VBAR_MESSAGE(type, enumerator)              \
  template <>                                       \
  struct MessageTraits<type> {                      \
    static constexpr Apid kApid = Apid::enumerator; \
  };
VBAR_FOR_EACH_MESSAGE(VBAR_MESSAGE)
#undef VBAR_MESSAGE

/// Calls visit.template operator()<Message>() for every message that is a packet.
template <class Visitor>
constexpr void for_each_message(Visitor&& visit) {
#define VBAR_MESSAGE(type, enumerator) visit.template operator()<type>();
  VBAR_FOR_EACH_MESSAGE(VBAR_MESSAGE)
#undef VBAR_MESSAGE
}

/// The same for every message of telemetry.
template <class Visitor>
constexpr void for_each_telemetry(Visitor&& visit) {
  for_each_message([&]<class Message>() {
    if constexpr (is_telemetry(MessageTraits<Message>::kApid)) visit.template operator()<Message>();
  });
}

/// False if any floating-point field, inner messages and all elements included, is a NaN or an infinity. By the bits:
/// no compiler option for fast mathematics can make this always true.
template <class Value>
[[nodiscard]] bool all_finite(const Value& value) {
  if constexpr (std::is_array_v<Value>) {
    for (const auto& element : value) {
      if (!all_finite(element)) return false;
    }
    return true;
  } else if constexpr (std::is_floating_point_v<Value>) {
    constexpr std::uint64_t kExponentMask = 0x7FF0'0000'0000'0000U;
    return (std::bit_cast<std::uint64_t>(static_cast<double>(value)) & kExponentMask) != kExponentMask;
  } else if constexpr (std::is_class_v<Value>) {
    bool finite = true;
    visit_fields(value,
                 [&finite](const Field& /*field*/, const auto& member) { finite = finite && all_finite(member); });
    return finite;
  } else {
    return true;
  }
}

/// The message's name in vbar.lcm (also its LCM type name); null for an APID without a message.
[[nodiscard]] const char* message_name(Apid apid);

}  // namespace vbar::fsw::packets
