#pragma once
// The two ends of a batch of a step (frame.h): go-back-N with a cumulative acknowledgement. Both sides of a link use
// the same two state machines, one for the batch they send and one for the batch they receive. No I/O, no time, no
// storage of packets: the owner sends what the sender names, stores what the receiver takes, and decides when to poll.
// A batch has at most 65,535 packets.

#include <cstdint>

#include "fsw/link/frame.h"

namespace vbar::fsw::link {

/// Takes the kData frames of one batch in order, without gaps or repetitions.
class BatchReceiver {
 public:
  enum class Verdict : std::uint8_t {
    kTaken,       ///< the next packet: the owner stores its payload now
    kDuplicate,   ///< held already
    kOutOfOrder,  ///< one before it is missing
    kForeign,     ///< of another session or step, or no batch is open
  };
  struct Decision {
    Verdict verdict = Verdict::kForeign;
    bool acknowledge = false;  ///< the owner sends acknowledgement() now
  };

  /// Expects the batch of (session, step) from its first packet on.
  void open(std::uint32_t session, std::uint32_t step);
  /// Expects nothing any more: every frame is foreign.
  void close() { open_ = false; }

  /// Judges a kData frame.
  Decision offer(const FrameHeader& frame);

  /// kAck with the number of packets held.
  [[nodiscard]] FrameHeader acknowledgement() const;
  [[nodiscard]] bool is_open() const { return open_; }
  [[nodiscard]] bool complete() const { return complete_; }
  [[nodiscard]] std::uint32_t step() const { return step_; }
  /// Packets held without a gap.
  [[nodiscard]] std::uint16_t held() const { return held_; }

 private:
  std::uint32_t session_ = 0;
  std::uint32_t step_ = 0;
  std::uint16_t held_ = 0;
  bool open_ = false;
  bool complete_ = false;
};

/// Says which packet of a batch goes out next. At most kWindow are out without acknowledgement.
class BatchSender {
 public:
  /// Starts the batch of (session, step) with `count` packets, at least one.
  void open(std::uint32_t session, std::uint32_t step, std::uint16_t count);

  /// True while the window has room for another packet: the one of `next_header().index`.
  [[nodiscard]] bool can_send() const { return next_ < count_ && next_ - acknowledged_ < kWindow; }
  /// Header of the next packet to send; only while can_send().
  [[nodiscard]] FrameHeader next_header() const;
  /// The packet of next_header() was sent.
  void sent();

  /// The other side holds `held` packets. Older news, and more than was ever sent, changes nothing.
  void acknowledge(std::uint16_t held);
  /// The other side holds `held` packets and lost what followed: sending resumes there. Impossible numbers change
  /// nothing.
  void rewind(std::uint16_t held);

  [[nodiscard]] std::uint32_t step() const { return step_; }
  [[nodiscard]] std::uint16_t count() const { return count_; }
  [[nodiscard]] bool all_acknowledged() const { return acknowledged_ == count_; }
  /// Packets sent more than once, over all batches.
  [[nodiscard]] std::uint32_t resent() const { return resent_; }

 private:
  std::uint32_t session_ = 0;
  std::uint32_t step_ = 0;
  std::uint16_t count_ = 0;
  std::uint16_t next_ = 0;          ///< to be sent next
  std::uint16_t acknowledged_ = 0;  ///< held by the other side
  std::uint16_t furthest_ = 0;      ///< one past the last that was ever sent
  std::uint32_t resent_ = 0;
};

}  // namespace vbar::fsw::link
