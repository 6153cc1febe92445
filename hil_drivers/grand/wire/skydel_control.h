#pragma once
// Skydel's remote control over TCP. Frame: u16 LE length of the rest | u8 kind | payload. Commands and results are
// JSON; a result is i32 LE length | JSON, NUL inside its frame. Source: the published client's bytes.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "fsw/core/gps_time.h"
#include "hil_drivers/grand/wire/bytes.h"

namespace vbar::grand::wire {

using Json = nlohmann::json;

enum class SkydelFrameKind : std::uint8_t { kCommand = 0, kResult = 1, kApiVersion = 2 };

inline constexpr std::uint32_t kSkydelApiVersion = 49;

// States of a simulator as its API numbers them.
inline constexpr int kSkydelStateIdle = 1, kSkydelStateStarted = 2, kSkydelStateError = 3;
inline constexpr int kSkydelSubStateIdleWithoutConfig = 1, kSkydelSubStateIdle = 2, kSkydelSubStateStreaming = 5,
                     kSkydelSubStateArmed = 8, kSkydelSubStateError = 10, kSkydelSubStateSyncStart = 13;
inline constexpr std::string_view kSkydelStreaming = "Streaming RF";

/// Frame of either direction.
struct SkydelFrame {
  SkydelFrameKind kind = SkydelFrameKind::kCommand;
  Json json = {};                 ///< object of a command or a result
  std::uint32_t api_version = 0;  ///< number in a frame of the API version
};

/// Returns a command; `fields` is an object.
Json skydel_command(std::string_view name, std::string_view uuid, const Json& fields = Json::object());
/// Returns a result to `command`.
Json skydel_result(std::string_view name, const Json& command, const Json& fields = Json::object());
Json skydel_error(const Json& command, std::string_view message);

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

}  // namespace vbar::grand::wire
