#include "fsw/link/cobs.h"

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

}  // namespace vbar::fsw::link
