#pragma once
// Admission of senders. Any program may send to a board; a session has one peer.
//
// The first sender of a valid kHello becomes the peer. Frames of other senders are rejected and counted until the
// session ends: with its kGoodbye, or, so that a host that died does not lock a board, once the peer has been silent
// for a while and another sender sends a kHello.

#include <cstdint>
#include <span>

#include "fsw/link/frame.h"

namespace vbar::boards {

/// Admits one sender to a session. `Sender` is a sender, as far as the board's interfaces distinguish senders; it has
/// operator==.
template <class Sender>
class SessionGuard {
 public:
  /// `silence`, in the unit of the times given to `admits`, is the time without frames of the peer after which another
  /// sender may become the peer.
  explicit SessionGuard(std::uint64_t silence) : silence_(silence) {}

  /// Returns true if the frame, received at `now`, is for the flight software. A kHello that is admitted makes its
  /// sender the peer.
  bool admits(const Sender& sender, std::span<const std::uint8_t> frame, std::uint64_t now) {
    if (has_peer_ && sender == peer_) {
      last_heard_ = now;
      return true;
    }
    const bool is_free = !has_peer_ || now - last_heard_ >= silence_;
    if (!is_free || !is_hello(frame)) return false;
    peer_ = sender;
    has_peer_ = true;
    last_heard_ = now;
    return true;
  }

  /// Restores the peer after a reset at `now`: that of the session which the reset ended. It is answered until another
  /// sender says kHello.
  void resume(const Sender& peer, std::uint64_t now) {
    peer_ = peer;
    has_peer_ = true;
    last_heard_ = now;
  }

  /// Ends the session after the peer's kGoodbye.
  void end_session() { has_peer_ = false; }

  [[nodiscard]] bool has_peer() const { return has_peer_; }
  /// Returns the destination of answers; valid while has_peer().
  [[nodiscard]] const Sender& peer() const { return peer_; }

 private:
  static bool is_hello(std::span<const std::uint8_t> frame) {
    const auto parsed = fsw::link::parse_frame(frame);
    return parsed.ok() && parsed.value().header.type == fsw::link::FrameType::kHello;
  }

  std::uint64_t silence_;
  std::uint64_t last_heard_ = 0;
  Sender peer_;
  bool has_peer_ = false;
};

}  // namespace vbar::boards
