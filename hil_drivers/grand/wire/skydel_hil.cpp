#include "hil_drivers/grand/wire/skydel_hil.h"

#include <cmath>

#include <fmt/format.h>

namespace vbar::grand::wire {
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
