#include "fsw/link/frame.h"

#include <algorithm>

#include "fsw/packets/big_endian.h"
#include "fsw/packets/crc.h"

namespace vbar::fsw::link {

namespace {

/// Code of a full group: 254 bytes follow, and no zero is implied after them.
constexpr std::uint8_t kFullGroup = 0xFF;

}  // namespace

Result<std::size_t> cobs_encode(std::span<const std::uint8_t> data, std::span<std::uint8_t> out) {
  if (out.size() < 2) return Status::kTooLong;
  std::size_t code_at = 0;
  std::size_t end = 1;
  std::uint8_t code = 1;
  for (std::size_t i = 0; i < data.size(); ++i) {
    if (data[i] != 0) {
      if (end == out.size()) return Status::kTooLong;
      out[end++] = data[i];
      ++code;
    }
    // A full group at the end of the data needs no successor.
    const bool full = code == kFullGroup && i + 1 < data.size();
    if (data[i] != 0 && !full) continue;
    if (end == out.size()) return Status::kTooLong;
    out[code_at] = code;
    code_at = end++;
    code = 1;
  }
  if (end == out.size()) return Status::kTooLong;
  out[code_at] = code;
  out[end++] = 0;
  return end;
}

bool CobsDecoder::push(std::uint8_t byte) {
  frame_size_ = 0;
  if (byte == 0) {
    const bool well_formed = in_frame_ && !bad_ && remaining_ == 0;
    if (in_frame_ && !well_formed) ++rejected_;
    if (well_formed) frame_size_ = size_;
    restart();
    return well_formed;
  }
  in_frame_ = true;
  if (bad_) return false;
  if (remaining_ > 0) {
    append(byte);
    --remaining_;
    return false;
  }
  if (zero_after_group_) append(0);
  remaining_ = static_cast<std::uint8_t>(byte - 1U);
  zero_after_group_ = byte != kFullGroup;
  return false;
}

void CobsDecoder::append(std::uint8_t byte) {
  if (size_ == buffer_.size()) {
    bad_ = true;
    return;
  }
  buffer_[size_++] = byte;
}

void CobsDecoder::restart() {
  size_ = 0;
  remaining_ = 0;
  zero_after_group_ = false;
  in_frame_ = false;
  bad_ = false;
}

namespace {

using packets::read_big_endian;
using packets::write_big_endian;

constexpr std::size_t kSessionOffset = 2;
constexpr std::size_t kStepOffset = 6;
constexpr std::size_t kIndexOffset = 10;
constexpr std::size_t kFlagsOffset = 12;
constexpr std::size_t kReservedOffset = 13;
constexpr std::uint32_t kLastBit = 1U;
constexpr std::uint32_t kAcknowledgeNowBit = 2U;

// Little-endian, the order in which IEEE 802.3 sends its check sequence.
std::uint32_t read_crc(std::span<const std::uint8_t> bytes, std::size_t offset) {
  std::uint32_t crc = 0;
  for (std::size_t i = kFrameCrcBytes; i > 0; --i) crc = (crc << 8U) | bytes[offset + i - 1];
  return crc;
}

void write_crc(std::uint32_t crc, std::span<std::uint8_t> bytes, std::size_t offset) {
  for (std::size_t i = 0; i < kFrameCrcBytes; ++i) {
    bytes[offset + i] = static_cast<std::uint8_t>(crc & 0xFFU);
    crc >>= 8U;
  }
}

bool is_frame_type(std::uint8_t value) {
  return value >= static_cast<std::uint8_t>(FrameType::kHello) &&
         value <= static_cast<std::uint8_t>(FrameType::kSnapshotHeld);
}

}  // namespace

Result<std::size_t> write_frame(const FrameHeader& header, std::span<const std::uint8_t> payload,
                                std::span<std::uint8_t> out) {
  if (payload.size() > kMaxFrameBytes - kFrameHeaderBytes - kFrameCrcBytes) return Status::kTooLong;
  const std::size_t frame_bytes = kFrameHeaderBytes + payload.size() + kFrameCrcBytes;
  if (out.size() < frame_bytes) return Status::kTooLong;
  out[0] = kProtocolVersion;
  out[1] = static_cast<std::uint8_t>(header.type);
  write_big_endian(header.session, out, kSessionOffset);
  write_big_endian(header.step, out, kStepOffset);
  write_big_endian(header.index, out, kIndexOffset);
  out[kFlagsOffset] =
      static_cast<std::uint8_t>((header.last ? kLastBit : 0U) | (header.acknowledge_now ? kAcknowledgeNowBit : 0U));
  out[kReservedOffset] = 0;
  std::copy(payload.begin(), payload.end(), out.begin() + kFrameHeaderBytes);
  const std::size_t crc_offset = frame_bytes - kFrameCrcBytes;
  write_crc(packets::crc32_ieee(out.first(crc_offset)), out, crc_offset);
  return frame_bytes;
}

Result<FrameView> parse_frame(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < kFrameHeaderBytes + kFrameCrcBytes) return Status::kTooShort;
  if (bytes.size() > kMaxFrameBytes) return Status::kTooLong;
  const std::size_t crc_offset = bytes.size() - kFrameCrcBytes;
  if (packets::crc32_ieee(bytes.first(crc_offset)) != read_crc(bytes, crc_offset)) return Status::kBadChecksum;
  if (bytes[0] != kProtocolVersion || !is_frame_type(bytes[1])) return Status::kWrongType;
  const std::uint32_t flags = bytes[kFlagsOffset];
  if (flags > (kLastBit | kAcknowledgeNowBit) || bytes[kReservedOffset] != 0) return Status::kWrongType;
  FrameView frame;
  frame.header.type = static_cast<FrameType>(bytes[1]);
  frame.header.session = read_big_endian<std::uint32_t>(bytes, kSessionOffset);
  frame.header.step = read_big_endian<std::uint32_t>(bytes, kStepOffset);
  frame.header.index = read_big_endian<std::uint16_t>(bytes, kIndexOffset);
  frame.header.last = (flags & kLastBit) != 0;
  frame.header.acknowledge_now = (flags & kAcknowledgeNowBit) != 0;
  frame.payload = bytes.subspan(kFrameHeaderBytes, crc_offset - kFrameHeaderBytes);
  return frame;
}

}  // namespace vbar::fsw::link
