#include "hil_drivers/grand/wire/skydel.h"

#include <atomic>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "hil_drivers/grand/wire/calendar.h"

namespace vbar::grand::wire {

namespace {

constexpr std::size_t kLengthBytes = 2;
constexpr std::size_t kMaxRest = 65535;
/// Commands and results are flat; deeper ones would only exhaust the parser's stack.
constexpr int kMaxDepth = 16;

Bytes frame(SkydelFrameKind kind, std::size_t payload, auto put_payload) {
  if (payload + 1 > kMaxRest)
    throw WireError(fmt::format("Skydel frame: {} bytes do not fit into a frame of {}", payload + 1, kMaxRest));
  Bytes bytes;
  bytes.reserve(kLengthBytes + 1 + payload);
  ByteWriter writer(bytes);
  writer.put(static_cast<std::uint16_t>(payload + 1));
  writer.put(static_cast<std::uint8_t>(kind));
  put_payload(writer);
  return bytes;
}

/// `text` ends with NUL, which some clients leave out of a result.
Json parse_object(std::span<const std::uint8_t> text, std::string_view what) {
  if (!text.empty() && text.back() == 0) text = text.first(text.size() - 1);
  int depth = 0;
  bool is_too_deep = false;
  const auto limit_depth = [&](int level, Json::parse_event_t event, const Json&) {
    depth = level;
    is_too_deep = is_too_deep || depth > kMaxDepth;
    static_cast<void>(event);
    return !is_too_deep;
  };
  Json json;
  try {
    json = Json::parse(text.begin(), text.end(), limit_depth);
  } catch (const Json::parse_error& error) {
    throw WireError(fmt::format("{}: not JSON at byte {} of {}", what, error.byte, text.size()));
  }
  if (is_too_deep) throw WireError(fmt::format("{}: JSON nested more than {} deep", what, kMaxDepth));
  if (!json.is_object()) throw WireError(fmt::format("{}: the JSON is not an object", what));
  return json;
}

SkydelFrame decode(std::span<const std::uint8_t> rest, std::uint64_t offset) {
  const std::string what = fmt::format("Skydel frame at byte {} of the connection", offset);
  ByteReader reader(rest, what);
  SkydelFrame result;
  const auto kind = reader.get<std::uint8_t>("kind");
  switch (kind) {
    case static_cast<std::uint8_t>(SkydelFrameKind::kCommand):
      result.json = parse_object(rest.subspan(reader.position()), what);
      return result;
    case static_cast<std::uint8_t>(SkydelFrameKind::kResult): {
      result.kind = SkydelFrameKind::kResult;
      const auto length = reader.get<std::int32_t>("length of the result");
      if (length < 0 || static_cast<std::size_t>(length) != reader.remaining())
        reader.fail("length of the result", fmt::format("is {}, {} bytes follow", length, reader.remaining()));
      result.json = parse_object(rest.subspan(reader.position()), what);
      return result;
    }
    case static_cast<std::uint8_t>(SkydelFrameKind::kApiVersion):
      result.kind = SkydelFrameKind::kApiVersion;
      result.api_version = reader.get<std::uint32_t>("API version");
      reader.finish();
      return result;
    default:
      throw WireError(fmt::format("{}: kind {} is unknown; known are 0, 1 and 2", what, kind));
  }
}

const Json& field_of(const Json& json, std::string_view field, std::string_view expected) {
  const auto found = json.find(field);
  if (found == json.end())
    throw WireError(fmt::format("{}: field {} is missing; {} is expected", name_of(json), field, expected));
  return *found;
}

[[noreturn]] void fail_field(const Json& json, std::string_view field, std::string_view expected) {
  const auto shown = json.at(std::string(field)).dump(-1, ' ', true, Json::error_handler_t::replace);
  throw WireError(fmt::format("{}: field {} is {}; {} is expected", name_of(json), field, printable(shown), expected));
}

std::string text_of_json(const Json& json) {
  return json.dump(-1, ' ', true, Json::error_handler_t::replace);
}

}  // namespace

Json skydel_command(std::string_view name, std::string_view uuid, const Json& fields) {
  Json command = fields;
  command["CmdName"] = name;
  command["CmdUuid"] = uuid;
  return command;
}

Json skydel_result(std::string_view name, const Json& command, const Json& fields) {
  static std::atomic<std::uint64_t> results{0};
  Json result = fields;
  result["CmdName"] = name;
  result["CmdUuid"] = fmt::format("ffffffff-0000-4000-8000-{:012x}", ++results);
  result["RelatedCommand"] = text_of_json(command);
  return result;
}

Json skydel_failure(const Json& command, std::string_view message) {
  return skydel_result(kSkydelFailure, command, {{"ErrorMsg", message}});
}

std::string related_uuid(const Json& result) {
  const std::string text = text_field(result, "RelatedCommand");
  const std::span<const char> characters(text);
  const std::span bytes(reinterpret_cast<const std::uint8_t*>(characters.data()), characters.size());
  return text_field(parse_object(bytes, name_of(result) + ": RelatedCommand"), "CmdUuid");
}

Bytes encode_command(const Json& command) {
  const std::string text = text_of_json(command);
  return frame(SkydelFrameKind::kCommand, text.size() + 1, [&](ByteWriter& writer) {
    writer.put(std::string_view(text));
    writer.put(std::uint8_t{0});
  });
}

Bytes encode_result(const Json& result) {
  const std::string text = text_of_json(result);
  return frame(SkydelFrameKind::kResult, 4 + text.size() + 1, [&](ByteWriter& writer) {
    writer.put(static_cast<std::int32_t>(text.size() + 1));
    writer.put(std::string_view(text));
    writer.put(std::uint8_t{0});
  });
}

Bytes encode_api_version(std::uint32_t version) {
  return frame(SkydelFrameKind::kApiVersion, 4, [&](ByteWriter& writer) { writer.put(version); });
}

void SkydelFrames::append(std::span<const std::uint8_t> bytes) {
  buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(position_));
  position_ = 0;
  buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
}

std::optional<SkydelFrame> SkydelFrames::next() {
  const std::span<const std::uint8_t> waiting = std::span<const std::uint8_t>(buffer_).subspan(position_);
  if (waiting.size() < kLengthBytes) return std::nullopt;
  const std::size_t length = ByteReader(waiting, "Skydel frame").get<std::uint16_t>("length");
  if (waiting.size() < kLengthBytes + length) return std::nullopt;
  const std::uint64_t offset = consumed_;
  position_ += kLengthBytes + length;
  consumed_ += kLengthBytes + length;
  return decode(waiting.subspan(kLengthBytes, length), offset);
}

std::string name_of(const Json& json) {
  const auto name = json.find("CmdName");
  if (name == json.end() || !name->is_string()) throw WireError("Skydel JSON: CmdName is missing or not a text");
  return printable(name->get_ref<const std::string&>());
}

bool bool_field(const Json& json, std::string_view field) {
  const Json& value = field_of(json, field, "true or false");
  if (!value.is_boolean()) fail_field(json, field, "true or false");
  return value.get<bool>();
}

std::int64_t integer_field(const Json& json, std::string_view field, std::int64_t low, std::int64_t high) {
  const std::string expected = fmt::format("an integer from {} to {}", low, high);
  const Json& value = field_of(json, field, expected);
  // A number beyond the range of i64 is unsigned in this library.
  const bool fits = value.is_number_integer() &&
                    (!value.is_number_unsigned() || value.get<std::uint64_t>() <= std::uint64_t{INT64_MAX});
  if (!fits || value.get<std::int64_t>() < low || value.get<std::int64_t>() > high) fail_field(json, field, expected);
  return value.get<std::int64_t>();
}

double number_field(const Json& json, std::string_view field) {
  const Json& value = field_of(json, field, "a number");
  if (!value.is_number() || !std::isfinite(value.get<double>())) fail_field(json, field, "a finite number");
  return value.get<double>();
}

std::string text_field(const Json& json, std::string_view field) {
  const Json& value = field_of(json, field, "a text");
  if (!value.is_string()) fail_field(json, field, "a text");
  return value.get<std::string>();
}

Json skydel_date(fsw::GpsTime time) {
  const Calendar date = calendar_of(time);
  return {{"Spec", "UTC"},     {"Year", date.year},     {"Month", date.month},  {"Day", date.day},
          {"Hour", date.hour}, {"Minute", date.minute}, {"Second", date.second}};
}

fsw::GpsTime skydel_date_field(const Json& json, std::string_view field) {
  const Json& value = field_of(json, field, "a date");
  if (!value.is_object()) fail_field(json, field, "a date");
  Json date = value;
  date["CmdName"] = fmt::format("{}, {}", name_of(json), field);
  if (text_field(date, "Spec") != "UTC") fail_field(date, "Spec", "\"UTC\"");
  const auto part = [&](const char* name, std::int64_t low, std::int64_t high) {
    return static_cast<unsigned>(integer_field(date, name, low, high));
  };
  return time_of({static_cast<int>(part("Year", 1980, 2199)), part("Month", 1, 12), part("Day", 1, 31),
                  part("Hour", 0, 23), part("Minute", 0, 59), part("Second", 0, 59)});
}

namespace {

using fsw::Vector3;

enum class Id : std::uint8_t {
  kHello = 1,
  kBye = 2,
  kVehicleInfo = 3,
  kPosition = 5,
  kPositionAttitude = 6,
  kDynamics = 7,
  kDynamicsAttitude = 8
};

constexpr double kMaxTime_s = 100.0 * 86400.0;
constexpr double kNsPerMs = 1e6;

/// Angles and rates come as yaw, pitch, roll: about the axes z, y, x.
Vector3 reversed(const Vector3& v) {
  return v.reverse();
}

fsw::Duration time_field(ByteReader& reader) {
  const double ms = reader.finite("time");
  if (ms < 0.0 || ms > kMaxTime_s * 1e3) reader.fail("time", fmt::format("of {} ms is not from 0 to 100 days", ms));
  return {static_cast<std::int64_t>(std::llround(ms * kNsPerMs))};
}

SkydelSample decode_sample(ByteReader& reader, bool has_order, bool has_attitude) {
  SkydelSample message;
  message.has_attitude = has_attitude;
  if (has_order) {
    const auto order = reader.get<std::uint8_t>("order");
    if (order > 2) reader.fail("order", fmt::format("is {}; known are 0, 1 and 2", order));
    message.derivatives = order + 1;
  }
  TrajectorySample& sample = message.sample;
  sample.time = time_field(reader);
  sample.position_ecef_m = reader.vector("position");
  if (has_attitude) sample.yaw_pitch_roll = reader.vector("attitude");
  const auto pair = [&](std::string_view linear_name, Vector3& linear, std::string_view angular_name,
                        Vector3& angular) {
    linear = reader.vector(linear_name);
    if (has_attitude) angular = reversed(reader.vector(angular_name));
  };
  Vector3 angular_jerk;
  if (message.derivatives >= 1) pair("velocity", sample.velocity_ecef_mps, "angular velocity", sample.angular_rate);
  if (message.derivatives >= 2)
    pair("acceleration", sample.acceleration_ecef_mps2, "angular acceleration", sample.angular_acceleration);
  if (message.derivatives >= 3) pair("jerk", sample.jerk_ecef_mps3, "angular jerk", angular_jerk);
  const auto name_length = reader.get<std::uint32_t>("length of the name");
  const auto name = reader.take(name_length, "name");
  message.name.assign(name.begin(), name.end());
  return message;
}

SkydelVehicleInfo decode_info(ByteReader& reader) {
  SkydelVehicleInfo info;
  info.time_ms = reader.get<std::uint64_t>("time");
  if (static_cast<double>(info.time_ms) > kMaxTime_s * 1e3) reader.fail("time", "is beyond 100 days");
  info.position_ecef_m = reader.vector("position");
  info.yaw_pitch_roll = reader.vector("attitude");
  info.speed_mps = reader.finite("speed");
  info.heading = reader.finite("heading");
  info.odometer_m = reader.finite("odometer");
  return info;
}

SkydelHilMessage decode_body(Id id, ByteReader& reader) {
  switch (id) {
    case Id::kHello:
      return SkydelHello{};
    case Id::kBye:
      return SkydelBye{};
    case Id::kVehicleInfo:
      return decode_info(reader);
    case Id::kPosition:
      return decode_sample(reader, false, false);
    case Id::kPositionAttitude:
      return decode_sample(reader, false, true);
    case Id::kDynamics:
      return decode_sample(reader, true, false);
    case Id::kDynamicsAttitude:
      return decode_sample(reader, true, true);
  }
  reader.fail("id", fmt::format("{} is unknown; known are 1, 2, 3 and 5 to 8", static_cast<int>(id)));
}

}  // namespace

void check_sample(const TrajectorySample& sample, std::string_view what) {
  const auto require = [&](const Vector3& value, std::string_view field) {
    if (!value.allFinite()) throw WireError(fmt::format("{}: {} is not finite", what, field));
  };
  require(sample.position_ecef_m, "position");
  require(sample.velocity_ecef_mps, "velocity");
  require(sample.acceleration_ecef_mps2, "acceleration");
  require(sample.jerk_ecef_mps3, "jerk");
  require(sample.yaw_pitch_roll, "attitude");
  require(sample.angular_rate, "angular rate");
  require(sample.angular_acceleration, "angular acceleration");
  if (sample.time.ns < 0 || fsw::seconds(sample.time) > kMaxTime_s)
    throw WireError(fmt::format("{}: time {} s is not from 0 to 100 days", what, fsw::seconds(sample.time)));
}

Bytes encode_hello() {
  return {static_cast<std::uint8_t>(Id::kHello)};
}

Bytes encode_bye() {
  return {static_cast<std::uint8_t>(Id::kBye)};
}

Bytes encode_sample(const TrajectorySample& sample) {
  check_sample(sample, "Skydel sample");
  constexpr std::size_t kBytes = 206;
  constexpr std::uint8_t kJerkOrder = 2;
  Bytes bytes;
  bytes.reserve(kBytes);
  ByteWriter writer(bytes);
  writer.put(static_cast<std::uint8_t>(Id::kDynamicsAttitude));
  writer.put(kJerkOrder);
  writer.put(static_cast<double>(sample.time.ns) / kNsPerMs);
  writer.put(sample.position_ecef_m);
  writer.put(sample.yaw_pitch_roll);
  writer.put(sample.velocity_ecef_mps);
  writer.put(reversed(sample.angular_rate));
  writer.put(sample.acceleration_ecef_mps2);
  writer.put(reversed(sample.angular_acceleration));
  writer.put(sample.jerk_ecef_mps3);
  writer.put(Vector3(Vector3::Zero()));  // angular jerk
  writer.put(std::uint32_t{0});          // no name
  return bytes;
}

Bytes encode_vehicle_info(const SkydelVehicleInfo& info) {
  Bytes bytes;
  ByteWriter writer(bytes);
  writer.put(static_cast<std::uint8_t>(Id::kVehicleInfo));
  writer.put(info.time_ms);
  writer.put(info.position_ecef_m);
  writer.put(info.yaw_pitch_roll);
  writer.put(info.speed_mps);
  writer.put(info.heading);
  writer.put(info.odometer_m);
  return bytes;
}

SkydelHilMessage decode_hil(std::span<const std::uint8_t> datagram) {
  ByteReader reader(datagram, "Skydel HIL datagram");
  const auto id = static_cast<Id>(reader.get<std::uint8_t>("id"));
  SkydelHilMessage message = decode_body(id, reader);
  reader.finish();
  return message;
}

}  // namespace vbar::grand::wire
