#pragma once
// The list of all messages that travel as packets: one line each, with its number on the wire and its route.
//
// Everything that depends on which messages exist is derived from this list: the APIDs (packet.h), the traits and the
// codecs (message_traits.h, messages.h), the queues of the flight software's inbox and the sequence counters of its
// outbox (fsw/gnc). A new message is a struct in vbar.lcm and a line here.
//
// APIDs below 0x400 go to the flight software, from 0x400 on they come from it; telemetry is 0x500 to 0x5FF, what a
// board reports to its host, and what a sensor in another process exchanges with it, 0x600 to 0x6FF.

#include <cstddef>
#include <cstdint>

namespace vbar::fsw::packets {

enum class RouteKind : std::uint8_t {
  kQueue,       ///< to the flight software: waits for the step in a queue, in order of time tags
  kSpecial,     ///< to the flight software: the inbox itself has a place for it
  kFromFlight,  ///< from the flight software
  kBoard,       ///< between host and board or sensor; never given to the flight software, and not sent by it
};

/// Who sends a message to whom, and where it waits.
struct Route {
  RouteKind kind = RouteKind::kBoard;
  std::size_t capacity = 0;  ///< entries of the queue, 0 without one
  std::size_t units = 0;     ///< known header units of a telecommand, 0 ... units - 1; 0: not a telecommand
};

constexpr bool has_queue(const Route& route) {
  return route.kind == RouteKind::kQueue;
}
constexpr bool is_telecommand(const Route& route) {
  return route.units > 0;
}
constexpr bool is_from_flight(const Route& route) {
  return route.kind == RouteKind::kFromFlight;
}

/// Cameras whose images the flight software uses: header units 0 ... kCameras - 1.
inline constexpr std::size_t kCameras = 2;

namespace route {

constexpr Route queue(std::size_t capacity) {
  return {.kind = RouteKind::kQueue, .capacity = capacity};
}
/// Telecommands are rare: four of each kind may arrive in a step. The newest of each unit is kept
/// (fsw/messaging/telecommands.h).
constexpr Route telecommand(std::size_t units) {
  return {.kind = RouteKind::kQueue, .capacity = 4, .units = units};
}
inline constexpr Route kTelecommand = telecommand(1);
inline constexpr Route kSpecial{.kind = RouteKind::kSpecial};
inline constexpr Route kFromFlight{.kind = RouteKind::kFromFlight};
inline constexpr Route kBoard{.kind = RouteKind::kBoard};

// Queue for the bytes of each receiver, 82 kB: twenty epochs of eighty signals.
inline constexpr Route kReceiver = queue(64);
inline constexpr Route kMeasurements = queue(64);
inline constexpr Route kManeuvers = queue(32);

}  // namespace route
}  // namespace vbar::fsw::packets

/// Expands X(message type, Apid enumerator, APID, route) for every message. The numbers are those on the wire: a line
/// may be added, but an APID is never given to another message.
#define VBAR_FOR_EACH_MESSAGE(X)                                                                      \
  X(::vbar::tick, kTick, 0x001, route::kSpecial)                                                      \
  X(::vbar::ideal_navigation, kIdealNavigation, 0x010, route::kMeasurements)                          \
  X(::vbar::gnss_bytes, kGnssBytes, 0x011, route::kReceiver)                                          \
  X(::vbar::crosslink_gnss_bytes, kCrosslinkGnssBytes, 0x012, route::kReceiver)                       \
  X(::vbar::attitude, kAttitude, 0x013, route::kMeasurements)                                         \
  X(::vbar::crosslink_attitude, kCrosslinkAttitude, 0x014, route::kMeasurements)                      \
  X(::vbar::image_tile, kImageTile, 0x015, route::kSpecial)                                           \
  X(::vbar::range_measurement, kRangeMeasurement, 0x016, route::kMeasurements)                        \
  X(::vbar::executed_maneuver, kExecutedManeuver, 0x020, route::kManeuvers)                           \
  X(::vbar::waypoint_table, kWaypointTable, 0x101, route::kTelecommand)                               \
  X(::vbar::gnc_configuration, kGncConfiguration, 0x102, route::kTelecommand)                         \
  X(::vbar::mode_command, kModeCommand, 0x103, route::kTelecommand)                                   \
  X(::vbar::navigation_configuration, kNavigationConfiguration, 0x104, route::kTelecommand)           \
  X(::vbar::camera_configuration, kCameraConfiguration, 0x105, route::telecommand(kCameras))          \
  X(::vbar::angles_only_configuration, kAnglesOnlyConfiguration, 0x106, route::telecommand(kCameras)) \
  X(::vbar::target_apriori, kTargetApriori, 0x107, route::kTelecommand)                               \
  X(::vbar::pose_configuration, kPoseConfiguration, 0x108, route::telecommand(kCameras))              \
  X(::vbar::range_configuration, kRangeConfiguration, 0x109, route::kTelecommand)                     \
  X(::vbar::earth_configuration, kEarthConfiguration, 0x10A, route::kTelecommand)                     \
  X(::vbar::thruster_configuration, kThrusterConfiguration, 0x10B, route::kTelecommand)               \
  X(::vbar::target_model, kTargetModel, 0x10C, route::kTelecommand)                                   \
  X(::vbar::receiver_configuration, kReceiverConfiguration, 0x10D, route::kTelecommand)               \
  X(::vbar::carrier_configuration, kCarrierConfiguration, 0x10E, route::kTelecommand)                 \
  X(::vbar::safety_configuration, kSafetyConfiguration, 0x10F, route::kTelecommand)                   \
  X(::vbar::fault_command, kFaultCommand, 0x110, route::kTelecommand)                                 \
  X(::vbar::maneuver_command, kManeuverCommand, 0x401, route::kFromFlight)                            \
  X(::vbar::pointing_command, kPointingCommand, 0x402, route::kFromFlight)                            \
  X(::vbar::exposure_command, kExposureCommand, 0x403, route::kFromFlight)                            \
  X(::vbar::telemetry_navigation, kTelemetryNavigation, 0x501, route::kFromFlight)                    \
  X(::vbar::telemetry_control, kTelemetryControl, 0x502, route::kFromFlight)                          \
  X(::vbar::telemetry_health, kTelemetryHealth, 0x503, route::kFromFlight)                            \
  X(::vbar::telemetry_gnss, kTelemetryGnss, 0x504, route::kFromFlight)                                \
  X(::vbar::telemetry_image, kTelemetryImage, 0x505, route::kFromFlight)                              \
  X(::vbar::telemetry_objects, kTelemetryObjects, 0x506, route::kFromFlight)                          \
  X(::vbar::telemetry_pose, kTelemetryPose, 0x507, route::kFromFlight)                                \
  X(::vbar::telemetry_telecommand, kTelemetryTelecommand, 0x508, route::kFromFlight)                  \
  X(::vbar::telemetry_range, kTelemetryRange, 0x509, route::kFromFlight)                              \
  X(::vbar::telemetry_event, kTelemetryEvent, 0x50A, route::kFromFlight)                              \
  X(::vbar::telemetry_safety, kTelemetrySafety, 0x50B, route::kFromFlight)                            \
  X(::vbar::step_report, kStepReport, 0x601, route::kBoard)                                           \
  X(::vbar::wired_bytes, kWiredBytes, 0x602, route::kBoard)                                           \
  X(::vbar::source_start, kSourceStart, 0x603, route::kBoard)                                         \
  X(::vbar::true_earth, kTrueEarth, 0x604, route::kBoard)                                             \
  X(::vbar::true_state, kTrueState, 0x605, route::kBoard)                                             \
  X(::vbar::source_command, kSourceCommand, 0x606, route::kBoard)                                     \
  X(::vbar::source_answer, kSourceAnswer, 0x607, route::kBoard)
