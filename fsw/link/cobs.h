#pragma once
// Consistent Overhead Byte Stuffing (Cheshire & Baker 1999): a zero byte occurs only between frames.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "fsw/core/result.h"
#include "fsw/link/frame.h"

namespace vbar::fsw::link {

/// Writes the COBS image of `data` followed by the zero delimiter; returns its length. kTooLong if `out` is too small.
Result<std::size_t> cobs_encode(std::span<const std::uint8_t> data, std::span<std::uint8_t> out);

/// Decodes a byte stream incrementally. Resynchronises at the next zero after anything malformed or oversized.
class CobsDecoder {
 public:
  /// Processes one byte. Returns true when it completes a well-formed frame, which `frame()` then returns until the
  /// next push.
  bool push(std::uint8_t byte);
  [[nodiscard]] std::span<const std::uint8_t> frame() const { return {buffer_.data(), frame_size_}; }
  /// Number of frames dropped so far: malformed (a code that runs past its zero) or oversized.
  [[nodiscard]] std::uint32_t rejected() const { return rejected_; }

 private:
  void append(std::uint8_t byte);
  void restart();
  std::array<std::uint8_t, kMaxFrameBytes> buffer_{};
  std::size_t size_ = 0;
  std::size_t frame_size_ = 0;
  std::uint8_t remaining_ = 0;     ///< literal bytes left in the current group
  bool zero_after_group_ = false;  ///< the current group ends in an implied zero
  bool in_frame_ = false;
  bool bad_ = false;
  std::uint32_t rejected_ = 0;
};

}  // namespace vbar::fsw::link
