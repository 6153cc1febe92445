#pragma once
// Who may speak to the flight software. Anybody may send to a board; a session has one peer.
//
// The first sender of a valid kHello becomes the peer. Frames of anybody else are refused and counted until the session
// ends: with its kGoodbye, or, so that a host that died does not lock a board, once the peer has been silent for a
// while and somebody else says hello.

#include <cstdint>
#include <span>

#include "fsw/link/frame.h"

namespace vbar::boards {

/// `Sender`: a sender, as far as the board's interfaces can tell senders apart; it has operator==.
template <class Sender>
class SessionGuard {
 public:
  /// `silence` in the unit of the times given to `admits`: how long a peer may say nothing before another may take
  /// over.
  explicit SessionGuard(std::uint64_t silence) : silence_(silence) {}

  /// True if the frame, received at `now`, is for the flight software. A kHello that is admitted makes its sender the
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

  /// The peer said goodbye.
  void end_session() { has_peer_ = false; }

  [[nodiscard]] bool has_peer() const { return has_peer_; }
  /// Where answers go; meaningful while has_peer().
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
