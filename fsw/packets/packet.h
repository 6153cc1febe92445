#pragma once
// CCSDS Space Packets (133.0-B-2) as this project uses them, all fields big-endian:
//
//   bytes 0-5    primary header: version 000, type (1 = telecommand: to the flight software), secondary-header flag 1,
//                APID (11 bits), sequence flags (2), sequence count (14), data length - 1 (16)
//   bytes 6-13   secondary header: GPS time, int64 ns since 1980-01-06
//   byte  14     secondary header: spacecraft number
//   byte  15     secondary header: unit number (which sensor or actuator of its kind)
//   16 ...       payload: an LCM-encoded message (its 8-byte type hash first), or a segment of one
//   last 2       CRC-16/CCITT-FALSE over everything before it
//
// A packet never exceeds kMaxPacketBytes, so that it fits one link frame and one UDP datagram of 1,400 bytes.

#include <cstddef>
#include <cstdint>
#include <span>

#include "fsw/core/gps_time.h"
#include "fsw/core/result.h"
#include "fsw/packets/message_list.h"

namespace vbar::fsw::packets {

inline constexpr std::size_t kPacketHeaderBytes = 16;
inline constexpr std::size_t kPacketCrcBytes = 2;
inline constexpr std::size_t kMaxPacketBytes = 1376;
inline constexpr std::size_t kMaxPayloadBytes = kMaxPacketBytes - kPacketHeaderBytes - kPacketCrcBytes;

/// Message kind: the enumerators and numbers of message_list.h.
enum class Apid : std::uint16_t {
#define VBAR_MESSAGE(type, enumerator, number, route) enumerator = (number),
  VBAR_FOR_EACH_MESSAGE(VBAR_MESSAGE)
#undef VBAR_MESSAGE
};

/// Returns true for APIDs of telemetry, whose bytes make `telemetry_sha256`.
constexpr bool is_telemetry(Apid apid) {
  return (static_cast<std::uint16_t>(apid) & 0x700U) == 0x500U;
}

/// Returns true for APIDs that go to the flight software.
constexpr bool is_to_flight(Apid apid) {
  return static_cast<std::uint16_t>(apid) < 0x400U;
}

enum class SequenceFlags : std::uint8_t { kContinuation = 0, kFirst = 1, kLast = 2, kUnsegmented = 3 };

struct PacketHeader {
  Apid apid = Apid::kTick;
  SequenceFlags flags = SequenceFlags::kUnsegmented;
  std::uint16_t sequence_count = 0;  ///< 14 bits, counts per APID
  GpsTime time;
  std::uint8_t spacecraft = 0;
  std::uint8_t unit = 0;
};

/// A checked packet; `payload` points into the bytes it was parsed from.
struct PacketView {
  PacketHeader header;
  std::span<const std::uint8_t> payload;
};

/// Checks length, version, flags and CRC. kTooShort, kTooLong (bytes beyond the stated length), kWrongType,
/// kBadChecksum.
Result<PacketView> parse_packet(std::span<const std::uint8_t> bytes);

/// Writes header, payload and CRC to `out`; returns the packet's length. kTooLong if the payload or `out` does not
/// allow it.
Result<std::size_t> write_packet(const PacketHeader& header, std::span<const std::uint8_t> payload,
                                 std::span<std::uint8_t> out);

}  // namespace vbar::fsw::packets
