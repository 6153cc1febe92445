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

/// Admits the frames of one peer. `Sender` identifies a sender by what the interfaces of the board distinguish; it has
/// operator==.
template <class Sender>
class SessionGuard {
 public:
  /// `silence` is the time without frames of the peer after which another sender may replace it, in the unit of the
  /// times given to `admits`.
  explicit SessionGuard(std::uint64_t silence) : silence_(silence) {}

  /// Returns true if the frame, received at `now`, is for the flight software. An admitted kHello makes its sender the
  /// peer.
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

  /// Restores the peer of the session that a reset has ended, at `now`. It is answered until another sender sends a
  /// kHello.
  void resume(const Sender& peer, std::uint64_t now) {
    peer_ = peer;
    has_peer_ = true;
    last_heard_ = now;
  }

  /// Ends the session, when the peer has sent kGoodbye.
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
