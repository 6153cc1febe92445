#pragma once
// Space packets of one unit on board, numbered in sequence.

#include <array>
#include <cstdint>
#include <optional>

#include "fsw/packets/messages.h"
#include "host_sim/twins/packet_source.h"

namespace vbar::twins {

class PacketEncoder {
 public:
  /// Makes an encoder; `spacecraft` and `unit` as in fsw/packets/packet.h. One encoder a message kind: sequences count
  /// per APID, from `sequence_count` (14 bits) on.
  PacketEncoder(std::uint8_t spacecraft, std::uint8_t unit, std::uint16_t sequence_count = 0)
      : spacecraft_(spacecraft), unit_(unit), sequence_count_(sequence_count) {}

  /// Encodes the next packet. The result is empty if the message holds a NaN or an infinity; the sequence then has no
  /// gap.
  template <class Message>
  std::optional<Packet> encode(fsw::GpsTime time, const Message& message) {
    fsw::packets::PacketHeader header;
    header.time = time;
    header.spacecraft = spacecraft_;
    header.unit = unit_;
    header.sequence_count = sequence_count_;
    std::array<std::uint8_t, fsw::packets::kMaxPacketBytes> buffer;
    const auto size = fsw::packets::encode(header, message, buffer);
    if (!size.ok()) return std::nullopt;
    sequence_count_ = static_cast<std::uint16_t>((sequence_count_ + 1U) & 0x3FFFU);  // 14 bits
    return Packet(buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(size.value()));
  }

 private:
  std::uint8_t spacecraft_;
  std::uint8_t unit_;
  std::uint16_t sequence_count_;
};

}  // namespace vbar::twins
