// Thousands of steps over a line that loses, repeats, swaps, delays and spoils frames: the flight software must hear
// and say the same as when it is called directly, without any link.

#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "boards/common/flight_executive.h"
#include "boards/common/outbox.h"
#include "fsw/packets/messages.h"
#include "tests/unit/boards/common/fake_gnc.h"
#include "tests/unit/boards/common/reference_host.h"

namespace vbar::testing {

namespace {

constexpr std::uint8_t kSpacecraft = 3;

/// Inputs of a step: mostly few packets, sometimes more than two windows of them, the tick last.
std::vector<Bytes> inputs_of(std::uint32_t step) {
  std::mt19937 random(step + 1);
  std::vector<Bytes> packets;
  for (std::uint32_t count = random() % 10 == 0 ? random() % 90 : random() % 5; count > 0; --count) {
    packets.push_back(fake_output(random(), static_cast<int>(count)));
  }
  packets.push_back(tick_packet(step, std::int64_t{step} * 10'000'000'000));
  return packets;
}

/// What the flight software says when nothing is in between.
class DirectGnc {
 public:
  DirectGnc() {
    vbar_gnc_init(
        state_, kSpacecraft,
        [](void* context, const std::uint8_t* packet, std::size_t size) {
          static_cast<DirectGnc*>(context)->said_.emplace_back(packet, packet + size);
        },
        this);
  }
  std::vector<Bytes> step(const std::vector<Bytes>& packets, std::int64_t time_ns) {
    said_.clear();
    for (const Bytes& packet : packets) vbar_gnc_receive(state_, packet.data(), packet.size());
    vbar_gnc_step(state_, time_ns);
    return said_;
  }

 private:
  alignas(8) unsigned char state_[64]{};
  std::vector<Bytes> said_;
};

vbar::step_report report_in(const Bytes& packet) {
  const auto view = fsw::packets::parse_packet(packet);
  EXPECT_TRUE(view.ok());
  const auto report = fsw::packets::decode<vbar::step_report>(view.value());
  EXPECT_TRUE(report.ok());
  return report.value();
}

class FlightExecutiveLine : public ::testing::Test {
 protected:
  FlightExecutiveLine() { reset_fake_gnc(); }

  /// Plays `steps` steps over a line with `faults`; the last report.
  vbar::step_report play(const Faults& faults, std::uint32_t seed, std::uint32_t steps) {
    Line to_board(faults, seed);
    Line from_board(faults, seed + 1);
    const auto board = std::make_unique<boards::FlightExecutive>(platform_on(from_board));
    remember_an_earlier_run(to_board);
    ReferenceHost host(*board, to_board, from_board, 0xABCD0000U + seed);
    EXPECT_EQ(host.hello(kSpacecraft), "test board");
    DirectGnc direct;
    vbar::step_report report{};
    for (std::uint32_t step = 0; step < steps; ++step) {
      const std::vector<Bytes> packets = inputs_of(step);
      const std::vector<Bytes> expected = direct.step(packets, std::int64_t{step} * 10'000'000'000);
      auto answer = host.step(step, packets);
      if (!answer || answer->empty()) {
        ADD_FAILURE() << "no answer to step " << step;
        return report;
      }
      report = report_in(answer->back());
      EXPECT_EQ(report.step, step);
      answer->pop_back();
      if (*answer != expected) {
        ADD_FAILURE() << "another answer to step " << step;
        return report;
      }
    }
    polls_ = host.polls();
    return report;
  }

  int polls_ = 0;

 private:
  /// Frames of another session that look like the coming ones.
  static void remember_an_earlier_run(Line& line) {
    for (std::uint32_t step = 0; step < 20; ++step) {
      fsw::link::FrameHeader header;
      header.session = 0x01D5E551;
      header.step = step;
      header.last = true;
      for (const auto type : {fsw::link::FrameType::kData, fsw::link::FrameType::kAck, fsw::link::FrameType::kPoll,
                              fsw::link::FrameType::kGoodbye}) {
        header.type = type;
        line.remember(make_frame(header, tick_packet(step, 0)));
      }
    }
  }
};

TEST_F(FlightExecutiveLine, ACleanLineNeedsNoPollAndResendsNothing) {
  const vbar::step_report report = play({}, 1, 2000);
  EXPECT_EQ(polls_, 0);
  EXPECT_EQ(report.frames_rejected, 0);
  EXPECT_EQ(report.frames_duplicated, 0);
  EXPECT_EQ(report.frames_resent, 0);
}

TEST_F(FlightExecutiveLine, LostFramesAreSentAgain) {
  const vbar::step_report report = play({.lost = 100}, 2, 1000);
  EXPECT_GT(polls_, 0);
  EXPECT_GT(report.frames_resent, 0);
}

TEST_F(FlightExecutiveLine, DuplicatedFramesAreCounted) {
  EXPECT_GT(play({.duplicated = 200}, 3, 1000).frames_duplicated, 0);
}

TEST_F(FlightExecutiveLine, FlippedBitsAreRejected) {
  EXPECT_GT(play({.bit_flipped = 100}, 4, 1000).frames_rejected, 0);
}

TEST_F(FlightExecutiveLine, DroppedBytesAreRejected) {
  EXPECT_GT(play({.byte_dropped = 100}, 5, 1000).frames_rejected, 0);
}

TEST_F(FlightExecutiveLine, DelayedFramesAreTakenInOrder) {
  EXPECT_GT(play({.delayed = 150}, 6, 1000).frames_rejected, 0);
}

TEST_F(FlightExecutiveLine, StaleFramesOfThisAndOtherSessionsAreHarmless) {
  const vbar::step_report report = play({.stale = 300}, 7, 1000);
  EXPECT_GT(report.frames_rejected, 0);
  EXPECT_GT(report.frames_duplicated, 0);
}

TEST_F(FlightExecutiveLine, NoiseBetweenFramesIsRejected) {
  EXPECT_GT(play({.noise_inserted = 200}, 8, 1000).frames_rejected, 0);
}

TEST_F(FlightExecutiveLine, EverythingAtOnce) {
  for (std::uint32_t seed = 100; seed < 104; ++seed) {
    play({.lost = 40,
          .duplicated = 40,
          .bit_flipped = 40,
          .byte_dropped = 40,
          .delayed = 40,
          .stale = 60,
          .noise_inserted = 40},
         seed, 1000);
  }
}

}  // namespace

}  // namespace vbar::testing

namespace vbar::boards {

// The outbox keeps the oldest packets, never overwrites, and always has room for the report.

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
