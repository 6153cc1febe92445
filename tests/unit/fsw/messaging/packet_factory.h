#pragma once
// Packets as a mission's host makes them, for tests of the flight software.

#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "fsw/packets/messages.h"

namespace vbar::fsw::gnc::test {

using Bytes = std::vector<std::uint8_t>;

inline constexpr std::uint8_t kServicer = 1;

template <class Message>
Bytes packet_of(GpsTime time, const Message& message, std::uint16_t sequence = 0, std::uint8_t spacecraft = kServicer,
                std::uint8_t unit = 0) {
  packets::PacketHeader header;
  header.time = time;
  header.spacecraft = spacecraft;
  header.unit = unit;
  header.sequence_count = sequence;
  Bytes bytes(packets::kMaxPacketBytes);
  const auto size = packets::encode(header, message, bytes);
  EXPECT_TRUE(size.ok());
  bytes.resize(size.ok() ? size.value() : 0);
  return bytes;
}

}  // namespace vbar::fsw::gnc::test
