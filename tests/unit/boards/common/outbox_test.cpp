// The outbox keeps the oldest packets, never overwrites, and always has room for the report.

#include "boards/common/outbox.h"

#include <memory>
#include <vector>

#include <gtest/gtest.h>

namespace vbar::boards {
namespace {

using Bytes = std::vector<std::uint8_t>;
constexpr std::size_t kLargest = fsw::packets::kMaxPacketBytes;

Bytes packet_at(const Outbox& outbox, std::size_t index) {
  const auto packet = outbox.packet(static_cast<std::uint16_t>(index));
  return {packet.begin(), packet.end()};
}

Bytes numbered(std::size_t size, std::size_t number) {
  Bytes bytes(size, static_cast<std::uint8_t>(number));
  bytes[0] = static_cast<std::uint8_t>(number >> 8U);
  return bytes;
}

void expect_fills_up_and_still_takes_a_report(std::size_t packet_bytes, std::size_t expected_count) {
  const auto outbox = std::make_unique<Outbox>();
  std::size_t kept = 0;
  while (kept < 2 * kOutboxPackets && outbox->append(numbered(packet_bytes, kept))) ++kept;
  EXPECT_EQ(kept, expected_count);
  EXPECT_FALSE(outbox->append(numbered(packet_bytes, kept)));
  const Bytes report(kLargest, 0xEE);
  outbox->append_report(report);
  ASSERT_EQ(outbox->count(), kept + 1);
  for (std::size_t i = 0; i < kept; ++i) EXPECT_EQ(packet_at(*outbox, i), numbered(packet_bytes, i)) << i;
  EXPECT_EQ(packet_at(*outbox, kept), report);
}

TEST(Outbox, FullOfLargestPacketsStillTakesTheReport) {
  expect_fills_up_and_still_takes_a_report(kLargest, (kOutboxBytes - kLargest) / kLargest);
}

TEST(Outbox, FullOfShortPacketsStillTakesTheReport) {
  expect_fills_up_and_still_takes_a_report(18, kOutboxPackets - 1);
}

TEST(Outbox, RefusesWhatIsNoPacket) {
  const auto outbox = std::make_unique<Outbox>();
  EXPECT_FALSE(outbox->append({}));
  EXPECT_FALSE(outbox->append(Bytes(kLargest + 1)));
  EXPECT_EQ(outbox->count(), 0);
}

TEST(Outbox, ClearedItStartsAgain) {
  const auto outbox = std::make_unique<Outbox>();
  EXPECT_TRUE(outbox->append(Bytes{1, 2}));
  outbox->clear();
  EXPECT_TRUE(outbox->append(Bytes{3}));
  ASSERT_EQ(outbox->count(), 1);
  EXPECT_EQ(packet_at(*outbox, 0), Bytes{3});
}

}  // namespace
}  // namespace vbar::boards
