#pragma once
// Skydel's remote control over TCP. Frame: u16 LE length of the rest | u8 kind | payload. Commands and results are
// JSON; a result is i32 LE length | JSON, NUL inside its frame. Source: the published client's bytes.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include <nlohmann/json.hpp>

#include "fsw/core/gps_time.h"
#include "hil_drivers/grand/wire/bytes.h"
#include "hil_drivers/grand/wire/trajectory_sample.h"

namespace vbar::grand::wire {

using Json = nlohmann::json;

enum class SkydelFrameKind : std::uint8_t { kCommand = 0, kResult = 1, kApiVersion = 2 };

inline constexpr std::uint32_t kSkydelApiVersion = 49;

// States of a simulator as its API numbers them.
inline constexpr int kSkydelStateNone = 0, kSkydelStateIdle = 1, kSkydelStateStarted = 2, kSkydelStateError = 3;
inline constexpr int kSkydelSubStateNone = 0, kSkydelSubStateConfigNotValid = 1, kSkydelSubStateConfigValid = 2,
                     kSkydelSubStateStreaming = 5, kSkydelSubStateArmed = 8, kSkydelSubStateError = 10;
inline constexpr std::string_view kSkydelStreaming = "Streaming RF";

/// Frame of either direction.
struct SkydelFrame {
  SkydelFrameKind kind = SkydelFrameKind::kCommand;
  Json json = {};                 ///< object of a command or a result
  std::uint32_t api_version = 0;  ///< number in a frame of the API version
};

/// Returns a command; `fields` is an object.
Json skydel_command(std::string_view name, std::string_view uuid, const Json& fields = Json::object());
/// Returns a result to `command`. As in the published API a result has a uuid of its own; the command's is that of the
/// text in RelatedCommand.
Json skydel_result(std::string_view name, const Json& command, const Json& fields = Json::object());
inline constexpr std::string_view kSkydelFailure = "FailureResult";
Json skydel_failure(const Json& command, std::string_view message);
/// Returns the uuid of the command that a result answers. Throws WireError.
std::string related_uuid(const Json& result);

// Frames. Throw WireError if they do not fit into 65535 bytes.
Bytes encode_command(const Json& command);
Bytes encode_result(const Json& result);
Bytes encode_api_version(std::uint32_t version);

/// Cuts a stream into frames.
class SkydelFrames {
 public:
  void append(std::span<const std::uint8_t> bytes);
  /// Returns the next complete frame. Throws WireError for one that does not decode; after it the stream has no frame
  /// boundary at which to continue.
  std::optional<SkydelFrame> next();

 private:
  Bytes buffer_;
  std::size_t position_ = 0;  ///< position of the next frame in the buffer
  std::uint64_t consumed_ = 0;
};

// Fields of JSON objects, checked. Throw WireError with command and field.
std::string name_of(const Json& json);
bool bool_field(const Json& json, std::string_view field);
std::int64_t integer_field(const Json& json, std::string_view field, std::int64_t low, std::int64_t high);
double number_field(const Json& json, std::string_view field);
std::string text_field(const Json& json, std::string_view field);

/// Returns {"Spec": "UTC", "Year": ...}: GPS time in spite of its Spec.
Json skydel_date(fsw::GpsTime time);
fsw::GpsTime skydel_date_field(const Json& json, std::string_view field);

// Skydel's hardware-in-the-loop datagrams over UDP: packed, little-endian, time in ms since the start.

inline constexpr std::size_t kSkydelMaxHilBytes = 512;  ///< a sample with a name of 300 bytes

struct SkydelHello {};
struct SkydelBye {};

/// Sample of the trajectory: a position (05), with attitude (06), with derivatives (07), with both (08).
struct SkydelSample {
  TrajectorySample sample;    ///< values that the datagram does not carry are zero
  int derivatives = 0;        ///< number of derivatives of the position: 0, or 1 to 3
  bool has_attitude = false;  ///< with as many derivatives
  std::string name = {};      ///< name of a jammer; empty for the vehicle
};

/// State that is sent back to the sender of the samples (03).
struct SkydelVehicleInfo {
  std::uint64_t time_ms = 0;
  fsw::Vector3 position_ecef_m = fsw::Vector3::Zero();
  fsw::Vector3 yaw_pitch_roll = fsw::Vector3::Zero();
  double speed_mps = 0.0;
  double heading = 0.0;  ///< rad
  double odometer_m = 0.0;
};

using SkydelHilMessage = std::variant<SkydelHello, SkydelBye, SkydelVehicleInfo, SkydelSample>;

Bytes encode_hello();
Bytes encode_bye();
/// Encodes a sample (08) with three derivatives, 206 bytes. The angular jerk is zero. Throws WireError for a sample
/// that is not finite.
Bytes encode_sample(const TrajectorySample& sample);
Bytes encode_vehicle_info(const SkydelVehicleInfo& info);

/// Decodes any datagram of either direction. Throws WireError.
SkydelHilMessage decode_hil(std::span<const std::uint8_t> datagram);

/// Rejects a sample with a number that is not finite or a time outside 0 to 100 days; `what` names the message.
void check_sample(const TrajectorySample& sample, std::string_view what);

}  // namespace vbar::grand::wire
