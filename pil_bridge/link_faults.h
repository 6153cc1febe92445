#pragma once
// Fault injection on a line, for tests and fault runs: decorators of the byte channel (corrupted and lost bytes) and of
// the frame transport (lost, repeated and late frames, a stalled line), driven by a seeded generator. The same seed
// gives the same faults at the same bytes and frames; the number of bytes and frames depends on timing, because polls
// do.

#include <chrono>
#include <cstdint>
#include <memory>

#include "pil_bridge/transport.h"

namespace vbar::pil {

/// Probabilities, separate for each direction.
struct LinkFaults {
  std::uint64_t seed = 1;
  double flip_bit_per_byte = 0.0;   ///< one bit of the byte is inverted; serial lines only
  double drop_byte_per_byte = 0.0;  ///< serial lines only
  double flip_bit_per_frame = 0.0;
  double drop_frame = 0.0;
  double duplicate_frame = 0.0;
  double delay_frame = 0.0;      ///< the frame is overtaken by the next one
  double stall_per_frame = 0.0;  ///< the line stalls before the frame, for `stall`
  std::chrono::milliseconds stall{200};

  [[nodiscard]] bool any_byte_fault() const { return flip_bit_per_byte > 0.0 || drop_byte_per_byte > 0.0; }
  [[nodiscard]] bool any_frame_fault() const {
    return flip_bit_per_frame > 0.0 || drop_frame > 0.0 || duplicate_frame > 0.0 || delay_frame > 0.0 ||
           stall_per_frame > 0.0;
  }
};

std::unique_ptr<ByteChannel> with_byte_faults(std::unique_ptr<ByteChannel> channel, const LinkFaults& faults);
std::unique_ptr<FrameTransport> with_frame_faults(std::unique_ptr<FrameTransport> transport, const LinkFaults& faults);

}  // namespace vbar::pil
