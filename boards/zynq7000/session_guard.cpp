#include "boards/zynq7000/session_guard.h"

#include "fsw/link/frame.h"

namespace vbar::boards::zynq7000 {
namespace {

bool is_hello(std::span<const std::uint8_t> frame) {
  const auto parsed = fsw::link::parse_frame(frame);
  return parsed.ok() && parsed.value().header.type == fsw::link::FrameType::kHello;
}

}  // namespace

bool SessionGuard::admits(const Sender& sender, std::span<const std::uint8_t> frame, std::uint64_t now) {
  if (has_peer_ && sender == peer_) {
    last_heard_ = now;
    return true;
  }
  const bool is_free = !has_peer_ || now - last_heard_ >= silence_;
  if (!is_free || !is_hello(frame)) {
    return false;
  }
  peer_ = sender;
  has_peer_ = true;
  last_heard_ = now;
  return true;
}

}  // namespace vbar::boards::zynq7000
