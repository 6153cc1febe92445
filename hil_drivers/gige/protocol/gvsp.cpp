#include "hil_drivers/gige/protocol/gvsp.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <stdexcept>
#include <string>

namespace vbar::gige::wire {

namespace {

std::uint16_t with_bits(std::uint16_t dn, int bits, int wanted) {
  return static_cast<std::uint16_t>(bits >= wanted ? dn >> (bits - wanted) : dn << (wanted - bits));
}

Bytes pack_12(int bits, std::span<const std::uint16_t> dn) {
  Bytes bytes(image_bytes(PixelFormat::kMono12Packed, dn.size()));
  for (std::size_t k = 0; k < dn.size(); k += 2) {
    const std::uint16_t first = with_bits(dn[k], bits, 12);
    const std::uint16_t second = k + 1 < dn.size() ? with_bits(dn[k + 1], bits, 12) : std::uint16_t{0};
    std::uint8_t* const at = bytes.data() + k / 2 * 3;
    at[0] = static_cast<std::uint8_t>(first >> 4);
    at[1] = static_cast<std::uint8_t>((first & 0xF) | (second & 0xF) << 4);
    if (k + 1 < dn.size()) at[2] = static_cast<std::uint8_t>(second >> 4);
  }
  return bytes;
}

std::vector<std::uint16_t> unpack_12(std::size_t pixels, ByteSpan bytes) {
  std::vector<std::uint16_t> dn(pixels);
  for (std::size_t k = 0; k < pixels; k += 2) {
    const std::uint8_t* const at = bytes.data() + k / 2 * 3;
    dn[k] = static_cast<std::uint16_t>(at[0] << 4 | (at[1] & 0xF));
    if (k + 1 < pixels) dn[k + 1] = static_cast<std::uint16_t>(at[2] << 4 | at[1] >> 4);
  }
  return dn;
}

}  // namespace

bool is_pixel_format(std::uint32_t number) {
  switch (static_cast<PixelFormat>(number)) {
    case PixelFormat::kMono8:
    case PixelFormat::kMono12Packed:
    case PixelFormat::kMono16:
      return true;
  }
  return false;
}

const char* name_of(PixelFormat format) {
  switch (format) {
    case PixelFormat::kMono8:
      return "Mono8";
    case PixelFormat::kMono12Packed:
      return "Mono12Packed";
    case PixelFormat::kMono16:
      return "Mono16";
  }
  return "?";
}

std::size_t image_bytes(PixelFormat format, std::size_t pixels) {
  switch (format) {
    case PixelFormat::kMono8:
      return pixels;
    case PixelFormat::kMono12Packed:
      return (pixels * 3 + 1) / 2;
    case PixelFormat::kMono16:
      return pixels * 2;
  }
  return 0;
}

Bytes pack_pixels(PixelFormat format, int bits, std::span<const std::uint16_t> dn) {
  if (format == PixelFormat::kMono12Packed) return pack_12(bits, dn);
  Bytes bytes(image_bytes(format, dn.size()));
  if (format == PixelFormat::kMono8) {
    std::transform(dn.begin(), dn.end(), bytes.begin(),
                   [bits](std::uint16_t value) { return static_cast<std::uint8_t>(with_bits(value, bits, 8)); });
    return bytes;
  }
  for (std::size_t k = 0; k < dn.size(); ++k)
    boost::endian::store_little_u16(bytes.data() + 2 * k, with_bits(dn[k], bits, 16));
  return bytes;
}

std::vector<std::uint16_t> unpack_pixels(PixelFormat format, std::size_t pixels, ByteSpan bytes) {
  const std::size_t needed = image_bytes(format, pixels);
  if (bytes.size() < needed)
    throw std::invalid_argument(std::to_string(pixels) + " pixels of " + name_of(format) + " need " +
                                std::to_string(needed) + " bytes, there are " + std::to_string(bytes.size()));
  if (format == PixelFormat::kMono12Packed) return unpack_12(pixels, bytes);
  if (format == PixelFormat::kMono8) return {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(pixels)};
  std::vector<std::uint16_t> dn(pixels);
  if (needed > 0) std::memcpy(dn.data(), bytes.data(), needed);
  if constexpr (std::endian::native == std::endian::big)
    for (std::uint16_t& value : dn) value = boost::endian::endian_reverse(value);
  return dn;
}

namespace {

constexpr std::size_t kLeaderBytes = 36;
constexpr std::size_t kTrailerBytes = 8;

void put_header(const StreamHeader& header, Bytes& datagram) {
  datagram.clear();
  append_u16(datagram, static_cast<std::uint16_t>(header.status));
  append_u16(datagram, header.block);
  datagram.push_back(static_cast<std::uint8_t>(header.kind));
  append_u24(datagram, header.packet);
}

[[noreturn]] void fail(std::size_t at, const std::string& problem) {
  throw std::invalid_argument("GVSP packet, byte " + std::to_string(at) + ": " + problem);
}

PayloadType payload_type_of(ByteSpan body, std::size_t header_bytes) {
  const std::uint16_t number = load_u16(body, 2);
  const auto type = static_cast<PayloadType>(number);
  switch (type) {
    case PayloadType::kImage:
    case PayloadType::kChunkData:
    case PayloadType::kExtendedImage:
      return type;
  }
  fail(header_bytes + 2, "payload type " + std::to_string(number) + " is not an image");
}

Leader decode_leader(ByteSpan body) {
  if (body.size() < kLeaderBytes) fail(kGvspHeaderBytes, "a leader of " + std::to_string(body.size()) + " bytes");
  Leader leader;
  leader.payload_type = payload_type_of(body, kGvspHeaderBytes);
  leader.timestamp_ticks = load_u64(body, 4);
  const std::uint32_t format = load_u32(body, 12);
  if (!is_pixel_format(format)) fail(kGvspHeaderBytes + 12, "unknown pixel format " + std::to_string(format));
  leader.format = static_cast<PixelFormat>(format);
  leader.width = load_u32(body, 16);
  leader.height = load_u32(body, 20);
  leader.x = load_u32(body, 24);
  leader.y = load_u32(body, 28);
  return leader;
}

Trailer decode_trailer(ByteSpan body) {
  if (body.size() < kTrailerBytes) fail(kGvspHeaderBytes, "a trailer of " + std::to_string(body.size()) + " bytes");
  return {payload_type_of(body, kGvspHeaderBytes), load_u32(body, 4)};
}

}  // namespace

void encode_leader(Status status, std::uint16_t block, const Leader& leader, Bytes& datagram) {
  put_header({status, block, PacketKind::kLeader, 0}, datagram);
  append_u16(datagram, 0);
  append_u16(datagram, static_cast<std::uint16_t>(leader.payload_type));
  append_u64(datagram, leader.timestamp_ticks);
  append_u32(datagram, static_cast<std::uint32_t>(leader.format));
  for (const std::uint32_t value : {leader.width, leader.height, leader.x, leader.y}) append_u32(datagram, value);
  append_u32(datagram, 0);  // no padding of lines and of the image
}

void encode_trailer(Status status, std::uint16_t block, std::uint32_t packet, const Trailer& trailer, Bytes& datagram) {
  put_header({status, block, PacketKind::kTrailer, packet}, datagram);
  append_u16(datagram, 0);
  append_u16(datagram, static_cast<std::uint16_t>(trailer.payload_type));
  append_u32(datagram, trailer.height);
}

void encode_data(Status status, std::uint16_t block, std::uint32_t packet, ByteSpan bytes, Bytes& datagram) {
  put_header({status, block, PacketKind::kData, packet}, datagram);
  datagram.insert(datagram.end(), bytes.begin(), bytes.end());
}

void encode_unavailable(std::uint16_t block, std::uint32_t packet, Bytes& datagram) {
  put_header({Status::kPacketUnavailable, block, PacketKind::kData, packet}, datagram);
}

StreamPacket decode_stream_packet(ByteSpan datagram) {
  if (datagram.size() < kGvspHeaderBytes) fail(0, std::to_string(datagram.size()) + " bytes are less than a header");
  StreamPacket packet;
  packet.header.status = static_cast<Status>(load_u16(datagram, 0));
  packet.header.block = load_u16(datagram, 2);
  packet.header.packet = load_u24(datagram, 5);
  packet.header.kind = static_cast<PacketKind>(datagram[4]);
  if (packet.header.block == 0) fail(2, "block 0");
  const ByteSpan body = datagram.subspan(kGvspHeaderBytes);
  const bool has_payload = packet.header.status == Status::kSuccess || packet.header.status == Status::kPacketResend;
  switch (packet.header.kind) {
    case PacketKind::kLeader:
      if (has_payload) packet.body = decode_leader(body);
      return packet;
    case PacketKind::kTrailer:
      if (has_payload) packet.body = decode_trailer(body);
      return packet;
    case PacketKind::kData:
      if (has_payload) packet.body = Data{body};
      return packet;
  }
  fail(4, "unknown packet kind " + std::to_string(datagram[4]));
}

}  // namespace vbar::gige::wire
