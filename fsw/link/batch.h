#pragma once
// The two ends of a batch of a step (frame.h): go-back-N with a cumulative acknowledgement. Both sides of a link use
// the same two state machines, one for the batch they send and one for the batch they receive. The machines do no I/O,
// have no time and store no packets: the owner sends the packet named by the sender, stores those accepted by the
// receiver, and decides when to poll. A batch has at most 65,535 packets.
// when to poll. A batch has at most 65,535 packets.

#include <cstdint>

#include "fsw/link/frame.h"

namespace vbar::fsw::link {

/// Accepts the kData frames of one batch in order, without gaps or repetitions.
class BatchReceiver {
 public:
  enum class Verdict : std::uint8_t {
    kTaken,       ///< the next packet: the owner stores its payload now
    kDuplicate,   ///< received already
    kOutOfOrder,  ///< one before it is missing
    kForeign,     ///< belongs to another session or step, or no batch is open
  };
  struct Decision {
    Verdict verdict = Verdict::kForeign;
    bool acknowledge = false;  ///< the owner sends acknowledgement() now
  };

  /// Expects the batch of (session, step) from its first packet on.
  void open(std::uint32_t session, std::uint32_t step);
  /// Closes the batch: every frame is then foreign.
  void close() { open_ = false; }

  /// Classifies a kData frame.
  Decision offer(const FrameHeader& frame);

  /// Returns a kAck with the number of packets received.
  [[nodiscard]] FrameHeader acknowledgement() const;
  [[nodiscard]] bool is_open() const { return open_; }
  [[nodiscard]] bool complete() const { return complete_; }
  [[nodiscard]] std::uint32_t step() const { return step_; }
  /// Number of packets received without a gap.
  [[nodiscard]] std::uint16_t held() const { return held_; }

 private:
  std::uint32_t session_ = 0;
  std::uint32_t step_ = 0;
  std::uint16_t held_ = 0;
  bool open_ = false;
  bool complete_ = false;
};

/// Selects the next packet of a batch to send. At most kWindow are outstanding without acknowledgement.
class BatchSender {
 public:
  /// Starts the batch of (session, step) with `count` packets, at least one.
  void open(std::uint32_t session, std::uint32_t step, std::uint16_t count);

  /// Returns true while the window has room for another packet: the one of `next_header().index`.
  [[nodiscard]] bool can_send() const { return next_ < count_ && next_ - acknowledged_ < kWindow; }
  /// Returns the header of the next packet to send; only while can_send().
  [[nodiscard]] FrameHeader next_header() const;
  /// Records that the packet of next_header() was sent.
  void sent();

  /// Records that the other side has received `held` packets. Older acknowledgements, and more than was ever sent, have
  /// no effect.
  void acknowledge(std::uint16_t held);
  /// Records that the other side has received `held` packets and lost the following ones: sending resumes there.
  /// Invalid numbers have no effect.
  void rewind(std::uint16_t held);

  [[nodiscard]] std::uint32_t step() const { return step_; }
  [[nodiscard]] std::uint16_t count() const { return count_; }
  [[nodiscard]] bool all_acknowledged() const { return acknowledged_ == count_; }
  /// Number of packets sent more than once, over all batches.
  [[nodiscard]] std::uint32_t resent() const { return resent_; }

 private:
  std::uint32_t session_ = 0;
  std::uint32_t step_ = 0;
  std::uint16_t count_ = 0;
  std::uint16_t next_ = 0;          ///< to be sent next
  std::uint16_t acknowledged_ = 0;  ///< received by the other side
  std::uint16_t furthest_ = 0;      ///< one past the last packet ever sent
  std::uint32_t resent_ = 0;
};

}  // namespace vbar::fsw::link
