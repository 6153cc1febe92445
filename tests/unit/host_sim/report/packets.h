#pragma once
// Packets of every kind, with a payload that differs from one to the next.

#include <array>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "fsw/packets/packet.h"

namespace vbar::report::test {

using Bytes = std::vector<std::uint8_t>;

inline Bytes packet_of(fsw::packets::Apid apid, std::uint16_t count) {
  fsw::packets::PacketHeader header;
  header.apid = apid;
  header.sequence_count = count;
  header.time = {60'000'000'000LL * count};
  const std::array<std::uint8_t, 3> payload{0x00, 0xFF, static_cast<std::uint8_t>(count)};
  Bytes packet(fsw::packets::kMaxPacketBytes);
  const auto size = fsw::packets::write_packet(header, payload, packet);
  EXPECT_TRUE(size.ok());
  packet.resize(size.value());
  return packet;
}

/// What passes the flight computer's border in a few steps, in order.
inline std::vector<Bytes> some_packets() {
  using fsw::packets::Apid;
  std::vector<Bytes> packets;
  for (std::uint16_t count = 0; count < 5; ++count) {
    for (const Apid apid : {Apid::kIdealNavigation, Apid::kTick, Apid::kManeuverCommand, Apid::kTelemetryNavigation,
                            Apid::kTelemetryControl, Apid::kTelemetryHealth, Apid::kStepReport}) {
      packets.push_back(packet_of(apid, count));
    }
  }
  return packets;
}

}  // namespace vbar::report::test
