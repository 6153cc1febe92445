// The record of a flight that outlasts a reset.

#include "boards/zynq7000/flight_record.h"

#include <string>

#include <gtest/gtest.h>

namespace vbar::boards::zynq7000 {
namespace {

FlightRecord example() {
  FlightRecord record;
  record.session = 0xC0FFEE01;
  record.step = 17;
  record.in_step = 1;
  set_peer(record, {Interface::kEthernet, {{1, 2, 3, 4, 5, 6}, {10, 0, 2, 2}, 40000}});
  return record;
}

std::string description(const FlightRecord& record) {
  std::array<char, 120> text{};
  text.fill('x');
  describe_reset(record, text);
  return text.data();
}

// After power-on the memory holds anything: zeros, ones, or a record in which bits have decayed.
TEST(FlightRecord, AChecksumTellsARecordFromOtherMemory) {
  EXPECT_NE(checksum_of({}), 0U);
  FlightRecord ones;
  ones.session = ones.step = ones.in_step = ones.expired = ones.is_ethernet = ones.port = 0xFFFFFFFFU;
  ones.address.fill(0xFF);
  ones.mac.fill(0xFF);
  EXPECT_NE(checksum_of(ones), 0xFFFFFFFFU);
  const RecordWords words = words_of(example());
  for (std::size_t word = 0; word < words.size(); ++word) {
    for (unsigned bit = 0; bit < 32; ++bit) {
      RecordWords flipped = words;
      flipped[word] ^= 1U << bit;
      EXPECT_NE(checksum_of(std::bit_cast<FlightRecord>(flipped)), checksum_of(example())) << word << " " << bit;
    }
  }
}

TEST(FlightRecord, KeepsThePeer) {
  const Sender host{Interface::kEthernet, {{1, 2, 3, 4, 5, 6}, {10, 0, 2, 2}, 40000}};
  EXPECT_EQ(peer_of(example()), host);
  EXPECT_EQ(peer_of(example()).peer.mac, host.peer.mac);
  FlightRecord record = example();
  set_peer(record, {Interface::kSerial, {}});
  EXPECT_EQ(peer_of(record).interface, Interface::kSerial);
}

TEST(FlightRecord, SaysWhyItsSessionHasEnded) {
  EXPECT_EQ(description(example()),
            "error: its watchdog reset it in step 17, which did not end within twice the budget of a step");
  FlightRecord record = example();
  record.in_step = 0;
  record.step = 4'294'967'295U;
  EXPECT_EQ(description(record), "error: its watchdog reset it after step 4294967295");
  record.in_step = 1;
  EXPECT_LT(description(record).size(), 120U);
  EXPECT_TRUE(description(record).ends_with("a step")) << "not cut off";
}

}  // namespace
}  // namespace vbar::boards::zynq7000
