#pragma once
// Edge of the generator's 1PPS as the emulator announces it on a Unix datagram socket: 20 bytes, little-endian.
//
//    0  i64  GPS time of the edge, ns
//    8  i64  CLOCK_MONOTONIC of the edge, ns
//   16  u32  number of the edge since the generator's start
//
// A client subscribes by sending one byte of any value to the socket, from an address of its own.

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "fsw/core/gps_time.h"

namespace vbar::grand::wire {

struct PpsDatagram {
  fsw::GpsTime gps;
  std::int64_t monotonic_ns = 0;
  std::uint32_t count = 0;
  bool operator==(const PpsDatagram&) const = default;
};

inline constexpr std::size_t kPpsDatagramBytes = 20;
/// Limit of both times: they lie in [0, kPpsTimeLimit_ns), so that differences and sums of two cannot overflow.
inline constexpr std::int64_t kPpsTimeLimit_ns = std::int64_t{1} << 62;

[[nodiscard]] std::array<std::uint8_t, kPpsDatagramBytes> encode_pps_datagram(const PpsDatagram& datagram);

/// Decodes a datagram. Empty for any other length and for a time outside its limits.
[[nodiscard]] std::optional<PpsDatagram> decode_pps_datagram(std::span<const std::uint8_t> bytes);

}  // namespace vbar::grand::wire
