// A receiver that is wired to the board: its bytes become inputs of the step before the tick, and the host is given the
// same ones.

#include <deque>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "boards/common/flight_executive.h"
#include "boards/common/receiver_port.h"
#include "fsw/packets/big_endian.h"
#include "fsw/packets/messages.h"
#include "tests/unit/boards/common/fake_gnc.h"
#include "tests/unit/boards/common/reference_host.h"

namespace vbar::boards {

namespace {

using fsw::link::FrameHeader;
using fsw::link::FrameType;
using testing::Bytes;
using testing::fake_gnc_settings;
using ::testing::HasSubstr;
using testing::make_frame;
using ::testing::StartsWith;
using testing::tick_packet;

constexpr std::uint32_t kSession = 0xC0FFEE02;
constexpr std::uint8_t kSpacecraft = 5;
constexpr std::uint32_t kBaud = 115200;
constexpr std::size_t kPieceBytes = 1280;

Bytes hello_payload(std::uint32_t baud) {
  return {kSpacecraft, static_cast<std::uint8_t>(baud >> 24U), static_cast<std::uint8_t>(baud >> 16U),
          static_cast<std::uint8_t>(baud >> 8U), static_cast<std::uint8_t>(baud)};
}

Bytes counted(std::size_t size) {
  Bytes bytes(size);
  std::iota(bytes.begin(), bytes.end(), std::uint8_t{1});
  return bytes;
}

class WiredReceiverTest : public ::testing::Test {
 protected:
  WiredReceiverTest() {
    testing::reset_fake_gnc();
    fake_gnc_settings().step_output = [](std::uint64_t digest) {
      return std::vector<Bytes>{testing::fake_output(digest, 1)};
    };
    make_board(true);
  }

  void make_board(bool has_line) {
    Platform platform;
    platform.context = this;
    platform.name = "unit";
    platform.send = [](void* context, std::span<const std::uint8_t> bytes) {
      const auto frame = fsw::link::parse_frame(bytes);
      ASSERT_TRUE(frame.ok());
      const auto payload = frame.value().payload;
      auto* const test = static_cast<WiredReceiverTest*>(context);
      test->sent_.emplace_back(frame.value().header, Bytes(payload.begin(), payload.end()));
    };
    if (has_line) {
      platform.open_receiver = [](void* context, std::uint32_t baud) {
        auto* const test = static_cast<WiredReceiverTest*>(context);
        test->baud_ = baud;
        if (baud != 0) test->line_.clear();
        return test->line_works_;
      };
      platform.read_receiver = [](void* context, std::span<std::uint8_t> out) {
        auto& line = static_cast<WiredReceiverTest*>(context)->line_;
        std::size_t count = 0;
        for (; count < out.size() && !line.empty(); line.pop_front()) out[count++] = line.front();
        return count;
      };
    }
    board_ = std::make_unique<FlightExecutive>(platform);
  }

  void on(FrameType type, const Bytes& payload = {}, std::uint32_t step = 0, std::uint16_t index = 0,
          bool last = false) {
    FrameHeader header;
    header.type = type;
    header.session = session_;
    header.step = step;
    header.index = index;
    header.last = last;
    sent_.clear();
    static_cast<void>(board_->on_frame(make_frame(header, payload)));
  }

  std::string hello(const Bytes& payload) {
    on(FrameType::kHello, payload);
    EXPECT_EQ(sent_.size(), 1U);
    return {sent_.front().second.begin(), sent_.front().second.end()};
  }

  void arrive(const Bytes& bytes) { line_.insert(line_.end(), bytes.begin(), bytes.end()); }

  std::uint64_t count() {
    on(FrameType::kReceiverPoll);
    if (sent_.size() != 1 || sent_.front().first.type != FrameType::kReceiverCount) return UINT64_MAX;
    EXPECT_EQ(sent_.front().second.size(), 8U);
    return fsw::packets::read_big_endian<std::uint64_t>(sent_.front().second, 0);
  }

  /// Bytes of the wired_bytes of a step with no input but its tick, and the packets of the flight software.
  Bytes step(std::uint32_t step, std::vector<Bytes>& others) {
    on(FrameType::kData, tick_packet(step, 1000 + step), step, 0, true);
    Bytes wired;
    others.clear();
    for (const auto& [header, payload] : sent_) {
      const auto view = fsw::packets::parse_packet(payload);
      EXPECT_TRUE(view.ok());
      const auto message = fsw::packets::decode<wired_bytes>(view.value());
      if (view.value().header.apid == fsw::packets::Apid::kStepReport) continue;
      if (!message.ok()) {
        others.push_back(payload);
        continue;
      }
      EXPECT_TRUE(others.empty()) << "the inputs of a step come before its outputs";
      EXPECT_EQ(view.value().header.time.ns, 1000 + step);
      wired.insert(wired.end(), message.value().data, message.value().data + message.value().count);
    }
    return wired;
  }

  std::uint32_t session_ = kSession;
  std::uint32_t baud_ = 0;
  bool line_works_ = true;
  std::deque<std::uint8_t> line_;
  std::vector<std::pair<FrameHeader, Bytes>> sent_;
  std::unique_ptr<FlightExecutive> board_;
};

TEST_F(WiredReceiverTest, TheHelloOpensItAtItsRateAndDiscardsWhatCameBefore) {
  arrive(counted(100));
  EXPECT_EQ(hello(hello_payload(kBaud)), "unit");
  EXPECT_EQ(baud_, kBaud);
  EXPECT_TRUE(board_->has_receiver());
  EXPECT_EQ(count(), 0U);
  arrive(counted(7));
  EXPECT_EQ(count(), 7U);
  EXPECT_EQ(hello(hello_payload(kBaud)), "unit");  // the same hello again: nothing is discarded
  EXPECT_EQ(count(), 7U);
  session_ = kSession + 1;
  EXPECT_EQ(hello(hello_payload(kBaud)), "unit");
  EXPECT_EQ(count(), 0U);
}

TEST_F(WiredReceiverTest, BytesAreInputsBeforeTheTickAndReturnToTheHost) {
  hello(hello_payload(kBaud));
  const Bytes bytes = counted(2 * kPieceBytes + 5);
  arrive(Bytes(bytes.begin(), bytes.begin() + 1000));
  board_->read_receiver();
  arrive(Bytes(bytes.begin() + 1000, bytes.end()));
  std::vector<Bytes> said;
  EXPECT_EQ(step(0, said), bytes);
  EXPECT_EQ(count(), bytes.size());

  // The same flight software, given these bytes as packets by a host.
  alignas(8) std::array<unsigned char, 64> state{};
  std::vector<Bytes> expected;
  const auto take = [](void* context, const std::uint8_t* packet, std::size_t size) {
    static_cast<std::vector<Bytes>*>(context)->emplace_back(packet, packet + size);
  };
  vbar_gnc_init(state.data(), kSpacecraft, take, &expected);
  for (std::size_t begin = 0; begin < bytes.size(); begin += kPieceBytes) {
    gnss_bytes message{};
    message.count = static_cast<std::int32_t>(std::min(kPieceBytes, bytes.size() - begin));
    std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(begin), message.count, message.data);
    fsw::packets::PacketHeader header;
    header.time.ns = 1000;
    header.spacecraft = kSpacecraft;
    header.sequence_count = static_cast<std::uint16_t>(begin / kPieceBytes);
    Bytes packet(fsw::packets::kMaxPacketBytes);
    packet.resize(fsw::packets::encode(header, message, packet).value());
    vbar_gnc_receive(state.data(), packet.data(), packet.size());
  }
  const Bytes tick = tick_packet(0, 1000);
  vbar_gnc_receive(state.data(), tick.data(), tick.size());
  vbar_gnc_step(state.data(), 1000);
  EXPECT_EQ(said, expected);

  EXPECT_EQ(step(1, said), Bytes{});  // nothing new
}

TEST_F(WiredReceiverTest, AFloodIsSpreadOverStepsAndItsExcessDropped) {
  hello(hello_payload(kBaud));
  arrive(counted(2 * ReceiverPort::kRingBytes));
  EXPECT_EQ(count(), ReceiverPort::kRingBytes);  // a board reads a bounded number of bytes at once
  EXPECT_EQ(count(), 2 * ReceiverPort::kRingBytes);
  // The window of the link: the host acknowledges what it has.
  const auto whole_step = [&](std::uint32_t number) {
    std::vector<Bytes> said;
    std::size_t bytes = step(number, said).size();
    while (!sent_.empty() && !sent_.back().first.last) {
      const auto held = static_cast<std::uint16_t>(sent_.back().first.index + 1);
      on(FrameType::kAck, {}, number, held);
      for (const auto& [header, payload] : sent_) {
        const auto message = fsw::packets::decode<wired_bytes>(fsw::packets::parse_packet(payload).value());
        if (message.ok()) bytes += static_cast<std::size_t>(message.value().count);
      }
    }
    return bytes;
  };
  EXPECT_EQ(whole_step(0), ReceiverPort::kPacketsPerStep * kPieceBytes);
  EXPECT_EQ(whole_step(1), ReceiverPort::kRingBytes - ReceiverPort::kPacketsPerStep * kPieceBytes);
  EXPECT_EQ(whole_step(2), 0U);
}

// A run can be replayed only if the host has everything that the flight software was given.
TEST_F(WiredReceiverTest, WhatFindsNoRoomInTheAnswerWaitsForTheNextStep) {
  fake_gnc_settings().init_output.assign(250, Bytes(30, 1));  // the first answer has room for five more, and the report
  hello(hello_payload(kBaud));
  const Bytes bytes = counted(20 * kPieceBytes);
  arrive(bytes);
  std::vector<Bytes> said;
  on(FrameType::kData, tick_packet(0, 1000), 0, 0, true);
  Bytes given = step(1, said);
  EXPECT_EQ(given, Bytes(bytes.end() - 15 * static_cast<std::ptrdiff_t>(kPieceBytes), bytes.end()));
}

TEST_F(WiredReceiverTest, ABatchWithoutATickLeavesTheBytesWhereTheyAre) {
  hello(hello_payload(kBaud));
  arrive(counted(50));
  on(FrameType::kData, Bytes(30, 1), 0, 0, true);
  EXPECT_EQ(sent_.size(), 1U);  // the report alone
  std::vector<Bytes> said;
  EXPECT_EQ(step(1, said), counted(50));
}

TEST_F(WiredReceiverTest, WithoutItASessionTakesNothingFromTheLine) {
  hello({kSpacecraft});
  EXPECT_EQ(baud_, 0U);
  arrive(counted(50));
  EXPECT_EQ(count(), UINT64_MAX);
  board_->read_receiver();
  std::vector<Bytes> said;
  EXPECT_EQ(step(0, said), Bytes{});
  EXPECT_EQ(line_.size(), 50U);
}

TEST_F(WiredReceiverTest, GoodbyeClosesTheLine) {
  hello(hello_payload(kBaud));
  on(FrameType::kGoodbye);
  EXPECT_EQ(baud_, 0U);
  EXPECT_FALSE(board_->has_receiver());
}

TEST_F(WiredReceiverTest, ABoardThatCannotHaveItRefusesTheSession) {
  line_works_ = false;
  EXPECT_THAT(hello(hello_payload(kBaud)), AllOf(StartsWith("error: "), HasSubstr("no line to a receiver")));
  line_works_ = true;
  session_ = 1;
  EXPECT_THAT(hello(hello_payload(0)), StartsWith("error: "));
  session_ = 2;
  EXPECT_THAT(hello({kSpacecraft, 1, 2}), AllOf(StartsWith("error: "), HasSubstr("rate in baud")));
  make_board(false);
  EXPECT_THAT(hello(hello_payload(kBaud)), StartsWith("error: "));
  session_ = 3;
  EXPECT_EQ(hello({kSpacecraft}), "unit");
}

}  // namespace

// Bytes of a wired receiver between two ticks: nothing is lost or reordered below the ring's size, the newest is
// dropped and counted_bytes above it, and the pieces are the packets that a host would have made.

namespace {

constexpr std::uint8_t kPortSpacecraft = 9;
constexpr fsw::GpsTime kStep{1'000'000'000'000'000'000};

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
