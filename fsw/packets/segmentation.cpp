#include "fsw/packets/segmentation.h"

#include <algorithm>

namespace vbar::fsw::packets {
namespace {

constexpr std::uint16_t kSequenceCountMask = 0x3FFF;

constexpr std::uint16_t following(std::uint16_t sequence_count) {
  return static_cast<std::uint16_t>((sequence_count + 1U) & kSequenceCountMask);
}

/// Sequence counts wrap: `a` is before `b` if it is in the half circle behind `b`.
constexpr bool is_before(std::uint16_t a, std::uint16_t b) {
  const std::uint32_t behind = (static_cast<std::uint32_t>(b) - a) & kSequenceCountMask;
  return behind != 0 && behind <= kSequenceCountMask / 2U;
}

}  // namespace

Segmenter::Segmenter(const PacketHeader& header, std::span<const std::uint8_t> payload, std::size_t segment_bytes)
    : header_(header), rest_(payload), segment_bytes_(std::clamp(segment_bytes, std::size_t{1}, kMaxPayloadBytes)) {}

Result<std::size_t> Segmenter::next(std::span<std::uint8_t> out) {
  if (done_) return Status::kNotReady;
  const bool last = rest_.size() <= segment_bytes_;
  if (first_) {
    header_.flags = last ? SequenceFlags::kUnsegmented : SequenceFlags::kFirst;
  } else {
    header_.flags = last ? SequenceFlags::kLast : SequenceFlags::kContinuation;
  }
  const std::size_t size = std::min(rest_.size(), segment_bytes_);
  const Result<std::size_t> written = write_packet(header_, rest_.first(size), out);
  if (!written.ok()) return written;
  rest_ = rest_.subspan(size);
  header_.sequence_count = following(header_.sequence_count);
  first_ = false;
  done_ = last;
  return written;
}

Result<PacketView> SegmentAssembly::push(const PacketView& packet) {
  const PacketHeader& header = packet.header;
  if (header.apid != stream_.apid || header.spacecraft != stream_.spacecraft || header.unit != stream_.unit) {
    return Status::kWrongType;
  }
  if (is_past(header)) {
    ++counters_.duplicates;
    return Status::kBadSequence;
  }
  switch (header.flags) {
    case SequenceFlags::kUnsegmented:
    case SequenceFlags::kFirst:
      return begin(packet);
    case SequenceFlags::kContinuation:
    case SequenceFlags::kLast:
      break;
  }
  return proceed(packet);
}

bool SegmentAssembly::is_past(const PacketHeader& header) const {
  // The time distinguishes a repetition from a sender that was restarted and counts from zero.
  return has_completed_ && is_before(header.sequence_count, completed_until_) && header.time <= completed_time_;
}

Result<PacketView> SegmentAssembly::begin(const PacketView& packet) {
  if (assembling_ && packet.header.sequence_count == first_.sequence_count && packet.header.time == first_.time) {
    ++counters_.duplicates;
    return Status::kBadSequence;
  }
  if (assembling_) ++counters_.abandoned;
  first_ = packet.header;
  first_.flags = SequenceFlags::kUnsegmented;
  expected_ = packet.header.sequence_count;
  size_ = 0;
  assembling_ = true;
  return take(packet);
}

Result<PacketView> SegmentAssembly::proceed(const PacketView& packet) {
  const PacketHeader& header = packet.header;
  if (!assembling_ || header.time != first_.time) {
    ++counters_.misplaced;
    return Status::kBadSequence;
  }
  if (header.sequence_count != expected_) {
    ++(is_before(header.sequence_count, expected_) ? counters_.duplicates : counters_.misplaced);
    return Status::kBadSequence;
  }
  return take(packet);
}

Result<PacketView> SegmentAssembly::take(const PacketView& packet) {
  if (packet.payload.size() > memory_.size() - size_) {
    ++counters_.oversized;
    assembling_ = false;
    return Status::kTooLong;
  }
  std::copy(packet.payload.begin(), packet.payload.end(), memory_.begin() + static_cast<std::ptrdiff_t>(size_));
  size_ += packet.payload.size();
  expected_ = following(expected_);
  const bool last = packet.header.flags == SequenceFlags::kLast || packet.header.flags == SequenceFlags::kUnsegmented;
  if (!last) return Status::kNotReady;
  ++counters_.messages;
  assembling_ = false;
  has_completed_ = true;
  completed_until_ = expected_;
  completed_time_ = first_.time;
  return PacketView{first_, memory_.first(size_)};
}

}  // namespace vbar::fsw::packets
