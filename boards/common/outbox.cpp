#include "boards/common/outbox.h"

#include <algorithm>

namespace vbar::boards {

void Outbox::clear() {
  count_ = 0;
}

bool Outbox::append(std::span<const std::uint8_t> packet) {
  if (packet.empty() || packet.size() > fsw::packets::kMaxPacketBytes) return false;
  const std::size_t used = count_ == 0 ? 0 : end_[count_ - 1U];
  if (count_ + 1U >= kOutboxPackets || used + packet.size() > kOutboxBytes - fsw::packets::kMaxPacketBytes)
    return false;
  store(packet);
  return true;
}

void Outbox::append_report(std::span<const std::uint8_t> packet) {
  store(packet);
}

std::span<const std::uint8_t> Outbox::packet(std::uint16_t index) const {
  const std::size_t begin = index == 0 ? 0 : end_[index - 1U];
  return std::span(bytes_).subspan(begin, end_[index] - begin);
}

void Outbox::store(std::span<const std::uint8_t> packet) {
  const std::size_t begin = count_ == 0 ? 0 : end_[count_ - 1U];
  std::copy(packet.begin(), packet.end(), bytes_.begin() + static_cast<std::ptrdiff_t>(begin));
  end_[count_] = static_cast<std::uint32_t>(begin + packet.size());
  ++count_;
}

}  // namespace vbar::boards
