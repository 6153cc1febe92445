// Bursts of a receiver, cut at its TIME logs (log 101 of the OEM6 manual).

#include "hil_drivers/grand/bursts.h"

#include <gtest/gtest.h>

#include "tests/unit/hil_drivers/grand/driver/receiver_logs.h"

namespace vbar::grand {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr fsw::GpsTime kEpoch{fsw::duration_of_seconds(1658 * 604800LL + 345'679).ns};

TEST(Bursts, EndWithTheirTimeLogHoweverTheyArrive) {
  const Bytes sent = burst_of(kEpoch, oem::TimeStatus::kFine, 7);
  BurstCutter cutter;
  for (std::size_t k = 0; k + 1 < sent.size(); ++k) EXPECT_TRUE(cutter.push({&sent[k], 1}).empty());
  const auto bursts = cutter.push({&sent.back(), 1});
  ASSERT_EQ(bursts.size(), 1U);
  EXPECT_EQ(bursts[0].bytes, sent);
  EXPECT_EQ(bursts[0].tag.time, kEpoch);
  EXPECT_TRUE(bursts[0].tag.is_fine());
  EXPECT_EQ(bursts[0].tracked_signals, 7);
  EXPECT_EQ(cutter.rest_size(), 0U);
}

TEST(Bursts, KeepWhatCameBetweenThem) {
  Bytes sent{'\r', '\n', '<', 'O', 'K', 0xAA, 0x44, 0x12, 0xFF};
  const Bytes first = burst_of(kEpoch), second = burst_of(kEpoch + fsw::duration_of_seconds(10));
  sent.insert(sent.end(), first.begin(), first.end());
  sent.insert(sent.end(), second.begin(), second.end());
  sent.push_back(0x42);
  BurstCutter cutter;
  const auto bursts = cutter.push(sent);
  ASSERT_EQ(bursts.size(), 2U);
  EXPECT_EQ(bursts[0].bytes.size(), first.size() + 9);
  EXPECT_EQ(bursts[1].bytes, second);
  EXPECT_EQ(cutter.take_rest(), Bytes{0x42});
}

TEST(Bursts, AreNotFineBeforeTheReceiverHasTheTime) {
  for (const auto status : {oem::TimeStatus::kUnknown, oem::TimeStatus::kApproximate, oem::TimeStatus::kCoarse}) {
    BurstCutter cutter;
    const auto bursts = cutter.push(burst_of(kEpoch, status));
    ASSERT_EQ(bursts.size(), 1U);
    EXPECT_FALSE(bursts[0].tag.is_fine());
  }
}

TEST(Bursts, WithACorruptedTimeLogAreNotCut) {
  Bytes sent = burst_of(kEpoch);
  sent[sent.size() - 10] ^= 0x01;
  BurstCutter cutter;
  EXPECT_TRUE(cutter.push(sent).empty());
  EXPECT_EQ(cutter.counters().bad_checksum, 1U);
  EXPECT_EQ(cutter.rest_size(), sent.size());
}

TEST(Bursts, ShiftedByWeeksAreWhatTheReceiverWouldHaveSent) {
  const auto later = kEpoch + fsw::Duration{1024 * 604'800'000'000'000};
  Bytes sent = burst_of(later);
  sent.insert(sent.begin(), {0x00, 0xAA, 0x44});
  shift_weeks(sent, -1024);
  EXPECT_EQ(Bytes(sent.begin() + 3, sent.end()), burst_of(kEpoch));
}

}  // namespace
}  // namespace vbar::grand
