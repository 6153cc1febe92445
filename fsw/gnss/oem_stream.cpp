#include "fsw/gnss/oem_stream.h"

#include <algorithm>

#include "fsw/core/crc32.h"
#include "fsw/gnss/oem_fields.h"

namespace vbar::fsw::gnss {
namespace {

constexpr std::uint8_t kSync1 = 0xAA;
constexpr std::uint8_t kSync2 = 0x44;
constexpr std::uint8_t kSyncLong = 0x12;
constexpr std::uint8_t kSyncShort = 0x13;
constexpr std::size_t kSyncBytes = 3;
constexpr std::size_t kCrcBytes = 4;
constexpr std::size_t kLongHeaderBytes = 28;  // minimum; the header contains its length
constexpr std::size_t kShortHeaderBytes = 12;

// Bytes of the header that contain the message length.
constexpr std::size_t kLongLengthKnown = 10;
constexpr std::size_t kShortLengthKnown = 4;

}  // namespace

bool OemStream::push(std::uint8_t byte) {
  message_length_ = 0;
  if (size_ == buffer_.size()) make_room();
  buffer_[size_++] = byte;
  ++counters_.bytes;

  std::size_t kept = 0;
  for (std::size_t k = 0; k < open_count_; ++k) {
    Candidate candidate = open_[k];
    candidate.crc = crc32_after(candidate.crc, byte);
    const Verdict verdict = evaluate(candidate);
    if (verdict == Verdict::kWhole) {
      open_[k] = candidate;
      counters_.disproved += static_cast<std::uint32_t>(kept);
      report(k);
      return true;
    }
    if (verdict == Verdict::kOpen) open_[kept++] = candidate;
  }
  open_count_ = kept;
  open_at_sync();
  drop_what_no_candidate_holds();
  return false;
}

OemStream::Verdict OemStream::evaluate(Candidate& candidate) {
  if (candidate.length == 0) return read_length(candidate);
  if (size_ - candidate.start < candidate.length) return Verdict::kOpen;
  // The remainder over a message and its own CRC is zero.
  if (candidate.crc == 0) return Verdict::kWhole;
  ++counters_.bad_checksum;
  return Verdict::kFalse;
}

OemStream::Verdict OemStream::read_length(Candidate& candidate) {
  const auto seen = std::span<const std::uint8_t>(buffer_).subspan(candidate.start, size_ - candidate.start);
  if (seen[2] == kSyncShort) {
    if (seen.size() == kShortLengthKnown) candidate.length = kShortHeaderBytes + seen[3] + kCrcBytes;
    return Verdict::kOpen;
  }
  if (seen.size() < kLongLengthKnown) return Verdict::kOpen;
  const std::size_t header = seen[3];
  if (header < kLongHeaderBytes) {
    ++counters_.bad_header;
    return Verdict::kFalse;
  }
  candidate.length = header + read_little_endian<std::uint16_t>(seen, 8) + kCrcBytes;
  if (candidate.length <= kMaxOemMessageBytes) return Verdict::kOpen;
  ++counters_.oversized;
  return Verdict::kFalse;
}

void OemStream::report(std::size_t index) {
  message_start_ = open_[index].start;
  message_length_ = open_[index].length;
  ++counters_.messages;
  counters_.message_bytes += message_length_;
  open_count_ = 0;
  size_ = 0;  // the bytes stay in place until the next push
}

void OemStream::open_at_sync() {
  if (size_ < kSyncBytes) return;
  const auto last = std::span<const std::uint8_t>(buffer_).subspan(size_ - kSyncBytes, kSyncBytes);
  if (last[0] != kSync1 || last[1] != kSync2 || (last[2] != kSyncLong && last[2] != kSyncShort)) return;
  if (open_count_ == open_.size()) {
    std::copy(open_.begin() + 1, open_.end(), open_.begin());
    --open_count_;
    ++counters_.given_up;
  }
  Candidate candidate;
  candidate.start = size_ - kSyncBytes;
  candidate.crc = crc32_after(0, last);
  open_[open_count_++] = candidate;
}

void OemStream::drop_what_no_candidate_holds() {
  if (open_count_ > 0) return;
  const std::size_t prefix = sync_prefix_length();
  if (prefix > 0) {
    buffer_[0] = kSync1;
    buffer_[prefix - 1] = prefix == 1 ? kSync1 : kSync2;
  }
  size_ = prefix;
}

std::size_t OemStream::sync_prefix_length() const {
  if (size_ >= 1 && buffer_[size_ - 1] == kSync1) return 1;
  if (size_ >= 2 && buffer_[size_ - 2] == kSync1 && buffer_[size_ - 1] == kSync2) return 2;
  return 0;
}

void OemStream::make_room() {
  // Full implies an open candidate: without one, at most two bytes are kept.
  const std::size_t oldest = open_[0].start;
  std::copy(buffer_.begin() + static_cast<std::ptrdiff_t>(oldest), buffer_.end(), buffer_.begin());
  size_ -= oldest;
  for (std::size_t k = 0; k < open_count_; ++k) open_[k].start -= oldest;
}

OemMessage OemStream::message() const {
  const auto bytes = std::span<const std::uint8_t>(buffer_).subspan(message_start_, message_length_);
  OemMessage message;
  if (bytes.empty()) return message;
  const std::size_t end = bytes.size() - kCrcBytes;
  if (bytes[2] == kSyncShort) {
    message.id = read_little_endian<std::uint16_t>(bytes, 4);
    message.week = read_little_endian<std::uint16_t>(bytes, 6);
    message.time_of_week_ms = read_u32(bytes, 8);
    message.body = bytes.subspan(kShortHeaderBytes, end - kShortHeaderBytes);
    return message;
  }
  const unsigned type = bytes[6];
  message.id = read_little_endian<std::uint16_t>(bytes, 4);
  message.is_response = (type & 0x80U) != 0;
  message.format = static_cast<std::uint8_t>((type >> 5U) & 3U);
  message.source = static_cast<std::uint8_t>(type & 0x1FU);
  message.time_status = bytes[13];
  message.week = read_little_endian<std::uint16_t>(bytes, 14);
  message.time_of_week_ms = read_u32(bytes, 16);
  message.body = bytes.subspan(bytes[3], end - bytes[3]);
  return message;
}

}  // namespace vbar::fsw::gnss
