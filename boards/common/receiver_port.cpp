#include "boards/common/receiver_port.h"

#include <algorithm>

namespace vbar::boards {
namespace {

/// Mask of the sequence count in a packet header: 14 bits.
constexpr std::uint16_t kSequenceCounts = 0x4000;

/// Copies `out.size()` bytes of a ring from `begin` on.
void copy_from_ring(std::span<const std::uint8_t> ring, std::size_t begin, std::span<std::uint8_t> out) {
  const std::size_t until_wrap = std::min(out.size(), ring.size() - begin);
  std::copy_n(ring.begin() + static_cast<std::ptrdiff_t>(begin), until_wrap, out.begin());
  std::copy_n(ring.begin(), out.size() - until_wrap, out.begin() + static_cast<std::ptrdiff_t>(until_wrap));
}

}  // namespace

void ReceiverPort::open(std::uint8_t spacecraft) {
  spacecraft_ = spacecraft;
  begin_ = 0;
  size_ = 0;
  received_ = 0;
  dropped_ = 0;
  sequence_count_ = 0;
  is_open_ = true;
}

void ReceiverPort::take(std::span<const std::uint8_t> bytes) {
  received_ += bytes.size();
  const std::size_t kept = std::min(bytes.size(), bytes_.size() - size_);
  dropped_ += bytes.size() - kept;
  for (const std::uint8_t byte : bytes.first(kept)) {
    bytes_[(begin_ + size_) % bytes_.size()] = byte;
    ++size_;
  }
}

void ReceiverPort::begin_step() {
  if (sequence_count_ + kPacketsPerStep > kSequenceCounts) sequence_count_ = 0;
}

void ReceiverPort::next_piece(fsw::GpsTime step_time, WiredPiece& piece) const {
  gnss_bytes input{};
  piece.count = std::min(size_, sizeof input.data);
  piece.input_size = 0;
  piece.mirror_size = 0;
  if (piece.count == 0) return;
  const auto count = static_cast<std::int32_t>(piece.count);
  input.count = count;
  copy_from_ring(bytes_, begin_, std::span(input.data).first(piece.count));
  wired_bytes mirror{};
  mirror.received = static_cast<std::int64_t>(received_);
  mirror.dropped = static_cast<std::int64_t>(dropped_);
  mirror.count = count;
  static_assert(sizeof mirror.data == sizeof input.data);
  std::copy_n(input.data, piece.count, mirror.data);

  fsw::packets::PacketHeader header;
  header.sequence_count = sequence_count_;
  header.time = step_time;
  header.spacecraft = spacecraft_;
  // Cannot fail: the messages hold integers only, and both are smaller than a packet may be.
  piece.input_size = fsw::packets::encode(header, input, piece.input).value();
  piece.mirror_size = fsw::packets::encode(header, mirror, piece.mirror).value();
}

void ReceiverPort::accept(const WiredPiece& piece) {
  begin_ = (begin_ + piece.count) % bytes_.size();
  size_ -= piece.count;
  sequence_count_ = static_cast<std::uint16_t>((sequence_count_ + 1U) % kSequenceCounts);
}

}  // namespace vbar::boards
