// Bytes of a wired receiver between two ticks: nothing is lost or reordered below the ring's size, the newest is
// dropped and counted_bytes above it, and the pieces are the packets that a host would have made.

#include "boards/common/receiver_port.h"

#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/boards/common/reference_host.h"

namespace vbar::boards {
namespace {

using testing::Bytes;

constexpr std::uint8_t kPortSpacecraft = 9;
constexpr fsw::GpsTime kStep{1'000'000'000'000'000'000};
constexpr std::size_t kPieceBytes = 1280;  // vbar.lcm: gnss_bytes.data

Bytes counted_bytes(std::size_t size, std::size_t first = 0) {
  Bytes bytes(size);
  for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<std::uint8_t>((first + i) * 31U >> 3U);
  return bytes;
}

template <class Message>
Message message_in(const std::array<std::uint8_t, fsw::packets::kMaxPacketBytes>& packet, std::size_t size,
                   fsw::packets::PacketHeader& header) {
  const auto view = fsw::packets::parse_packet(std::span(packet).first(size));
  EXPECT_TRUE(view.ok());
  header = view.value().header;
  const auto message = fsw::packets::decode<Message>(view.value());
  EXPECT_TRUE(message.ok());
  return message.value();
}

class ReceiverPortTest : public ::testing::Test {
 protected:
  ReceiverPortTest() { port_->open(kPortSpacecraft); }

  /// All that is waiting, by the packets of one step; the sequence counts of these.
  Bytes cut(std::vector<std::uint16_t>* sequence_counts = nullptr) {
    Bytes all;
    WiredPiece piece;
    port_->begin_step();
    for (std::size_t k = 0; k < ReceiverPort::kPacketsPerStep; ++k) {
      port_->next_piece(kStep, piece);
      if (piece.count == 0) break;
      fsw::packets::PacketHeader of_input, of_mirror;
      const auto input = message_in<gnss_bytes>(piece.input, piece.input_size, of_input);
      const auto mirror = message_in<wired_bytes>(piece.mirror, piece.mirror_size, of_mirror);
      EXPECT_EQ(of_input.time, kStep);
      EXPECT_EQ(of_input.spacecraft, kPortSpacecraft);
      EXPECT_EQ(of_input.unit, 0);
      EXPECT_EQ(of_mirror.time, of_input.time);
      EXPECT_EQ(of_mirror.spacecraft, of_input.spacecraft);
      EXPECT_EQ(of_mirror.sequence_count, of_input.sequence_count);
      EXPECT_EQ(input.count, static_cast<std::int32_t>(piece.count));
      EXPECT_EQ(mirror.count, input.count);
      EXPECT_TRUE(std::equal(std::begin(input.data), std::end(input.data), std::begin(mirror.data)));
      EXPECT_EQ(mirror.received, static_cast<std::int64_t>(port_->received()));
      EXPECT_EQ(mirror.dropped, static_cast<std::int64_t>(port_->dropped()));
      all.insert(all.end(), input.data, input.data + input.count);
      if (sequence_counts != nullptr) sequence_counts->push_back(of_input.sequence_count);
      port_->accept(piece);
    }
    return all;
  }

  std::unique_ptr<ReceiverPort> port_ = std::make_unique<ReceiverPort>();
};

TEST_F(ReceiverPortTest, WithoutBytesThereIsNoPacket) {
  WiredPiece piece;
  port_->next_piece(kStep, piece);
  EXPECT_EQ(piece.count, 0U);
  EXPECT_EQ(piece.input_size, 0U);
  EXPECT_EQ(piece.mirror_size, 0U);
}

TEST_F(ReceiverPortTest, CutsAtThePacketsSizeAndNowhereElse) {
  for (const std::size_t size : {std::size_t{1}, kPieceBytes - 1, kPieceBytes, kPieceBytes + 1, 3 * kPieceBytes + 7}) {
    port_->take(counted_bytes(size));
    std::vector<std::uint16_t> sequence_counts;
    EXPECT_EQ(cut(&sequence_counts), counted_bytes(size));
    EXPECT_EQ(sequence_counts.size(), (size + kPieceBytes - 1) / kPieceBytes);
    EXPECT_EQ(port_->waiting(), 0U);
  }
}

TEST_F(ReceiverPortTest, APieceThatWasNotDeliveredComesAgain) {
  port_->take(counted_bytes(2 * kPieceBytes));
  WiredPiece first, again;
  port_->next_piece(kStep, first);
  port_->next_piece(kStep, again);
  EXPECT_EQ(first.input, again.input);
  EXPECT_EQ(cut(), counted_bytes(2 * kPieceBytes));
}

// The ring's end is crossed at every place: the pieces are of a size that has no factor in common with the ring's.
TEST_F(ReceiverPortTest, ManyStepsKeepOrderAndContent) {
  std::size_t sent = 0;
  for (int step = 0; step < 400; ++step) {
    const std::size_t size = 2711 + 13U * static_cast<std::size_t>(step % 50);
    port_->take(counted_bytes(size / 2, sent));
    port_->take(counted_bytes(size - size / 2, sent + size / 2));
    ASSERT_EQ(cut(), counted_bytes(size, sent)) << step;
    sent += size;
  }
  EXPECT_EQ(port_->received(), sent);
  EXPECT_EQ(port_->dropped(), 0U);
}

TEST_F(ReceiverPortTest, FullItDropsTheNewestAndCounts) {
  constexpr std::size_t kRing = ReceiverPort::kRingBytes;
  port_->take(counted_bytes(kRing - 5));
  port_->take(counted_bytes(20, kRing - 5));
  EXPECT_EQ(port_->received(), kRing + 15);
  EXPECT_EQ(port_->dropped(), 15U);
  EXPECT_EQ(port_->waiting(), kRing);
  // A step takes the packets it may; the others wait for the next one.
  Bytes all = cut();
  EXPECT_EQ(all.size(), ReceiverPort::kPacketsPerStep * kPieceBytes);
  const Bytes others = cut();
  all.insert(all.end(), others.begin(), others.end());
  EXPECT_EQ(all, counted_bytes(kRing));
}

TEST_F(ReceiverPortTest, MoreThanTheRingAtOnceIsDroppedAndCounted) {
  port_->take(counted_bytes(2 * ReceiverPort::kRingBytes));
  EXPECT_EQ(port_->waiting(), ReceiverPort::kRingBytes);
  EXPECT_EQ(port_->dropped(), ReceiverPort::kRingBytes);
}

// The flight software processes packets of one time in the order of their 14-bit counts.
TEST_F(ReceiverPortTest, SequenceCountsNeverWrapWithinAStep) {
  std::uint16_t last = 0;
  bool has_wrapped = false;
  for (int step = 0; step < 2000; ++step) {
    port_->take(counted_bytes(10 * kPieceBytes));
    std::vector<std::uint16_t> counts;
    cut(&counts);
    ASSERT_EQ(counts.size(), 10U);
    for (std::size_t k = 1; k < counts.size(); ++k) ASSERT_EQ(counts[k], counts[k - 1] + 1);
    ASSERT_LT(counts.back(), 0x4000);
    has_wrapped = has_wrapped || counts.front() < last;
    last = counts.back();
  }
  EXPECT_TRUE(has_wrapped);
}

TEST_F(ReceiverPortTest, ASessionBeginsEmpty) {
  port_->take(counted_bytes(100));
  port_->open(kPortSpacecraft);
  EXPECT_EQ(port_->waiting(), 0U);
  EXPECT_EQ(port_->received(), 0U);
  EXPECT_EQ(cut(), Bytes{});
  port_->close();
  EXPECT_FALSE(port_->is_open());
}

}  // namespace
}  // namespace vbar::boards
