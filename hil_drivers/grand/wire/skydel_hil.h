#pragma once
// Skydel's hardware-in-the-loop datagrams over UDP: packed, little-endian, time in ms since the start.

#include <array>
#include <span>
#include <string>
#include <variant>

#include "hil_drivers/grand/wire/bytes.h"
#include "hil_drivers/grand/wire/trajectory_sample.h"

namespace vbar::grand::wire {

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
