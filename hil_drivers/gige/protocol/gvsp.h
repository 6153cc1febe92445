#pragma once
// GVSP, the stream protocol of GigE Vision 1.2: an image is a block of packets, one UDP datagram each: leader (number
// 0), data (1 to N, all of one size but the last), trailer (N + 1).
//
//   header   u16 status, u16 block (never 0), u8 kind, u24 packet
//   leader   u16 0, u16 payload type, u64 time, u32 pixel format, u32 width, height, x, y, u16 padding x 2
//   trailer  u16 0, u16 payload type, u32 height

#include <cstdint>
#include <span>
#include <variant>
#include <vector>

#include "hil_drivers/gige/protocol/big_endian.h"
#include "hil_drivers/gige/protocol/gvcp.h"

namespace vbar::gige::wire {

// Pixels as a GigE Vision camera sends them. Mono16 is little-endian, and a converter of fewer bits stands left-aligned
// in it (12 bits: FFF0h); Mono12Packed (GigE Vision) puts two pixels into three bytes: P0 11..4, P1 3..0 | P0 3..0,
// P1 11..4.

enum class PixelFormat : std::uint32_t {
  kMono8 = 0x01080001,
  kMono12Packed = 0x010C0006,
  kMono16 = 0x01100007,
};

[[nodiscard]] bool is_pixel_format(std::uint32_t number);
[[nodiscard]] const char* name_of(PixelFormat format);
[[nodiscard]] std::size_t image_bytes(PixelFormat format, std::size_t pixels);

/// Packs `dn`: right-aligned numbers of a converter of `bits`, 8 to 16.
[[nodiscard]] Bytes pack_pixels(PixelFormat format, int bits, std::span<const std::uint16_t> dn);
/// Returns the numbers as they stand in `bytes`, Mono16 with its padding. Throws std::invalid_argument if bytes are
/// missing.
[[nodiscard]] std::vector<std::uint16_t> unpack_pixels(PixelFormat format, std::size_t pixels, ByteSpan bytes);

inline constexpr std::size_t kGvspHeaderBytes = 8;
/// Headers of IP, UDP and GVSP, which the packet size of a device counts.
inline constexpr std::size_t kPacketOverheadBytes = 20 + 8 + kGvspHeaderBytes;

enum class PacketKind : std::uint8_t { kLeader = 1, kTrailer = 2, kData = 3 };

/// Type of payload that the leader states; cameras that label images as chunk data exist (Aravis, issue 753).
enum class PayloadType : std::uint16_t { kImage = 0x0001, kChunkData = 0x0004, kExtendedImage = 0x4001 };

struct StreamHeader {
  Status status = Status::kSuccess;
  std::uint16_t block = 1;
  PacketKind kind = PacketKind::kData;
  std::uint32_t packet = 0;
  friend bool operator==(const StreamHeader&, const StreamHeader&) = default;
};

struct Leader {
  PayloadType payload_type = PayloadType::kImage;
  std::uint64_t timestamp_ticks = 0;
  PixelFormat format = PixelFormat::kMono16;
  std::uint32_t width = 0, height = 0, x = 0, y = 0;
  friend bool operator==(const Leader&, const Leader&) = default;
};

struct Trailer {
  PayloadType payload_type = PayloadType::kImage;
  std::uint32_t height = 0;
  friend bool operator==(const Trailer&, const Trailer&) = default;
};

/// Views the datagram.
struct Data {
  ByteSpan bytes;
};

/// Marks a packet that carries its status only: the device cannot send it again.
struct NoPayload {};

struct StreamPacket {
  StreamHeader header;
  std::variant<NoPayload, Leader, Trailer, Data> body;
};

// Encode a packet: each replaces the content of `datagram`, whose memory is so kept from packet to packet.
void encode_leader(Status status, std::uint16_t block, const Leader& leader, Bytes& datagram);
void encode_trailer(Status status, std::uint16_t block, std::uint32_t packet, const Trailer& trailer, Bytes& datagram);
void encode_data(Status status, std::uint16_t block, std::uint32_t packet, ByteSpan bytes, Bytes& datagram);
void encode_unavailable(std::uint16_t block, std::uint32_t packet, Bytes& datagram);

/// Decodes bytes from the network. Throws std::invalid_argument with the position of the error.
[[nodiscard]] StreamPacket decode_stream_packet(ByteSpan datagram);

}  // namespace vbar::gige::wire
