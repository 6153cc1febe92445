#include "fsw/packets/packet.h"

#include <algorithm>

#include "fsw/packets/big_endian.h"
#include "fsw/packets/crc.h"

namespace vbar::fsw::packets {
namespace {

constexpr std::uint32_t kVersionMask = 0xE000U;
constexpr std::uint32_t kTelecommandBit = 0x1000U;
constexpr std::uint32_t kSecondaryHeaderBit = 0x0800U;
constexpr std::uint32_t kApidMask = 0x07FFU;
constexpr std::uint32_t kSequenceCountMask = 0x3FFFU;
constexpr std::size_t kPrimaryHeaderBytes = 6;
constexpr std::size_t kTimeOffset = 6;
constexpr std::size_t kSpacecraftOffset = 14;
constexpr std::size_t kUnitOffset = 15;
constexpr std::size_t kMinPacketBytes = kPacketHeaderBytes + kPacketCrcBytes;

void write_header(const PacketHeader& header, std::size_t packet_bytes, std::span<std::uint8_t> out) {
  const auto apid = static_cast<std::uint32_t>(header.apid);
  const std::uint32_t type = is_to_flight(header.apid) ? kTelecommandBit : 0U;
  const std::uint32_t flags = static_cast<std::uint32_t>(header.flags) << 14U;
  write_big_endian(static_cast<std::uint16_t>(type | kSecondaryHeaderBit | apid), out, 0);
  write_big_endian(static_cast<std::uint16_t>(flags | (header.sequence_count & kSequenceCountMask)), out, 2);
  write_big_endian(static_cast<std::uint16_t>(packet_bytes - kPrimaryHeaderBytes - 1), out, 4);
  write_big_endian(static_cast<std::uint64_t>(header.time.ns), out, kTimeOffset);
  out[kSpacecraftOffset] = header.spacecraft;
  out[kUnitOffset] = header.unit;
}

PacketHeader read_header(std::span<const std::uint8_t> bytes) {
  const std::uint32_t sequence = read_big_endian<std::uint16_t>(bytes, 2);
  PacketHeader header;
  header.apid = static_cast<Apid>(read_big_endian<std::uint16_t>(bytes, 0) & kApidMask);
  header.flags = static_cast<SequenceFlags>(sequence >> 14U);
  header.sequence_count = static_cast<std::uint16_t>(sequence & kSequenceCountMask);
  header.time.ns = static_cast<std::int64_t>(read_big_endian<std::uint64_t>(bytes, kTimeOffset));
  header.spacecraft = bytes[kSpacecraftOffset];
  header.unit = bytes[kUnitOffset];
  return header;
}

/// Version 0, secondary header present, and the type bit that belongs to the APID.
bool identification_is_ours(std::uint32_t identification) {
  const bool to_flight = is_to_flight(static_cast<Apid>(identification & kApidMask));
  const std::uint32_t expected = kSecondaryHeaderBit | (to_flight ? kTelecommandBit : 0U);
  return (identification & (kVersionMask | kTelecommandBit | kSecondaryHeaderBit)) == expected;
}

}  // namespace

Result<PacketView> parse_packet(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < kMinPacketBytes) return Status::kTooShort;
  const std::size_t stated_bytes = read_big_endian<std::uint16_t>(bytes, 4) + kPrimaryHeaderBytes + 1;
  if (stated_bytes < kMinPacketBytes || bytes.size() < stated_bytes) return Status::kTooShort;
  if (stated_bytes > kMaxPacketBytes || bytes.size() > stated_bytes) return Status::kTooLong;
  const std::size_t crc_offset = stated_bytes - kPacketCrcBytes;
  if (crc16_ccitt_false(bytes.first(crc_offset)) != read_big_endian<std::uint16_t>(bytes, crc_offset)) {
    return Status::kBadChecksum;
  }
  if (!identification_is_ours(read_big_endian<std::uint16_t>(bytes, 0))) return Status::kWrongType;
  return PacketView{read_header(bytes), bytes.subspan(kPacketHeaderBytes, crc_offset - kPacketHeaderBytes)};
}

Result<std::size_t> write_packet(const PacketHeader& header, std::span<const std::uint8_t> payload,
                                 std::span<std::uint8_t> out) {
  if (static_cast<std::uint32_t>(header.apid) > kApidMask) return Status::kInvalidArgument;
  if (payload.size() > kMaxPayloadBytes) return Status::kTooLong;
  const std::size_t packet_bytes = kPacketHeaderBytes + payload.size() + kPacketCrcBytes;
  if (out.size() < packet_bytes) return Status::kTooLong;
  const std::span<std::uint8_t> body = out.subspan(kPacketHeaderBytes, payload.size());
  if (body.data() != payload.data()) std::copy(payload.begin(), payload.end(), body.begin());
  write_header(header, packet_bytes, out);
  const std::size_t crc_offset = packet_bytes - kPacketCrcBytes;
  write_big_endian(crc16_ccitt_false(out.first(crc_offset)), out, crc_offset);
  return packet_bytes;
}

}  // namespace vbar::fsw::packets
