// The ring between an interrupt handler and the main loop: order, the stated rule when full, and wrap-around.

#include <array>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "boards/zynq7000/byte_ring.h"
#include "boards/zynq7000/flight_record.h"
#include "boards/zynq7000/session_guard.h"
#include "boards/zynq7000/telecommand_key.h"
#include "fsw/link/frame.h"

namespace vbar::boards::zynq7000 {

namespace {

TEST(ByteRing, FullDropsTheNewestAndOverwritesNothing) {
  ByteRing<8> ring;
  for (std::uint8_t i = 0; i < 20; ++i) ring.push(i);
  EXPECT_EQ(ring.dropped(), 12U);
  std::uint8_t byte = 0;
  for (std::uint8_t i = 0; i < 8; ++i) {
    ASSERT_TRUE(ring.pop(byte));
    EXPECT_EQ(byte, i);
  }
  EXPECT_FALSE(ring.pop(byte));
  EXPECT_TRUE(ring.empty());
  ring.push(42);
  ASSERT_TRUE(ring.pop(byte));
  EXPECT_EQ(byte, 42);
}

// One writer and one reader at once, as an interrupt and the main loop are: every byte arrives once and in order.
TEST(ByteRing, OneWriterAndOneReader) {
  constexpr std::uint32_t kBytes = 20'000;
  ByteRing<64> ring;
  std::thread writer([&ring] {
    for (std::uint32_t i = 0; i < kBytes;) {
      const std::uint32_t dropped = ring.dropped();
      ring.push(static_cast<std::uint8_t>(i * 7U));
      if (ring.dropped() == dropped) {
        ++i;
      } else {
        std::this_thread::yield();  // full: the same byte again, so that the reader can demand all of them
      }
    }
  });
  for (std::uint32_t i = 0; i < kBytes; ++i) {
    std::uint8_t byte = 0;
    while (!ring.pop(byte)) std::this_thread::yield();
    ASSERT_EQ(byte, static_cast<std::uint8_t>(i * 7U)) << i;
  }
  writer.join();
}

}  // namespace

// The record of a flight that outlasts a reset.

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

TEST(TelecommandKeyOfTheImage, IsNoneWithIndexZero) {
  EXPECT_FALSE(telecommand_security({}, 5).has_value());
}

// The larger sequence number counts: a record of a flight that an image with a newer key follows is of the past.
TEST(TelecommandKeyOfTheImage, IsThatOfItsBytesAndOfTheFlightBeforeAReset) {
  TelecommandKeySettings settings{};
  settings.index = {0x12, 0x34};
  settings.sequence = {0, 0, 0, 1, 0, 0, 0, 2};
  settings.key[31] = 9;
  FlightRecord record;
  record.telecommand_sequence = halves_of(0x1'0000'0003);
  EXPECT_EQ(sequence_of(record), 0x1'0000'0003U);
  const auto cold = telecommand_security(settings, 0);
  ASSERT_TRUE(cold.has_value());
  EXPECT_EQ(cold->index, 0x1234);
  EXPECT_EQ(cold->sequence, 0x1'0000'0002U);
  EXPECT_EQ(cold->key[31], 9);
  EXPECT_EQ(telecommand_security(settings, sequence_of(record))->sequence, 0x1'0000'0003U);
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

// Who may lead a session, and when another may.

namespace {

using fsw::link::FrameType;

std::vector<std::uint8_t> link_frame(FrameType type) {
  std::array<std::uint8_t, fsw::link::kMaxFrameBytes> bytes{};
  fsw::link::FrameHeader header;
  header.type = type;
  header.session = 7;
  const auto size = fsw::link::write_frame(header, {}, bytes);
  return {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size.value())};
}

constexpr std::uint64_t kSilence = 1000;
const Sender kSerial{Interface::kSerial, {}};
const Sender kHost{Interface::kEthernet, {{}, {10, 0, 2, 2}, 40000}};
const Sender kOtherPort{Interface::kEthernet, {{}, {10, 0, 2, 2}, 40001}};
const Sender kOtherHost{Interface::kEthernet, {{}, {10, 0, 2, 3}, 40000}};

class SessionGuardTest : public testing::Test {
 protected:
  SessionGuard guard_{kSilence};
  std::vector<std::uint8_t> hello_ = link_frame(FrameType::kHello);
  std::vector<std::uint8_t> data_ = link_frame(FrameType::kData);
};

TEST_F(SessionGuardTest, OnlyAHelloOpensASession) {
  EXPECT_FALSE(guard_.admits(kSerial, data_, 0));
  EXPECT_FALSE(guard_.admits(kSerial, link_frame(FrameType::kGoodbye), 0));
  std::vector<std::uint8_t> broken = hello_;
  broken[5] ^= 1U;
  EXPECT_FALSE(guard_.admits(kSerial, broken, 0));
  EXPECT_FALSE(guard_.has_peer());
  EXPECT_TRUE(guard_.admits(kSerial, hello_, 0));
  EXPECT_EQ(guard_.peer(), kSerial);
}

TEST_F(SessionGuardTest, OthersAreRefusedAndThePeerIsNot) {
  ASSERT_TRUE(guard_.admits(kHost, hello_, 0));
  for (const Sender& other : {kSerial, kOtherPort, kOtherHost}) {
    EXPECT_FALSE(guard_.admits(other, data_, 1));
    EXPECT_FALSE(guard_.admits(other, hello_, 2));
  }
  EXPECT_TRUE(guard_.admits(kHost, data_, 3));
  EXPECT_TRUE(guard_.admits(kHost, hello_, 4));
  EXPECT_EQ(guard_.peer(), kHost);
}

// A frame that the line damaged is its peer's nevertheless; the executive counts it.
TEST_F(SessionGuardTest, ThePeersBrokenFramesAreAdmitted) {
  ASSERT_TRUE(guard_.admits(kSerial, hello_, 0));
  data_[3] ^= 0x10U;
  EXPECT_TRUE(guard_.admits(kSerial, data_, 1));
}

TEST_F(SessionGuardTest, GoodbyeFreesTheBoard) {
  ASSERT_TRUE(guard_.admits(kHost, hello_, 0));
  guard_.end_session();
  EXPECT_FALSE(guard_.admits(kSerial, data_, 1));
  EXPECT_TRUE(guard_.admits(kSerial, hello_, 2));
  EXPECT_FALSE(guard_.admits(kHost, data_, 3));
}

TEST_F(SessionGuardTest, AHelloTakesOverFromASilentPeer) {
  ASSERT_TRUE(guard_.admits(kHost, hello_, 0));
  ASSERT_TRUE(guard_.admits(kHost, data_, 500));
  EXPECT_FALSE(guard_.admits(kOtherPort, hello_, 500 + kSilence - 1));
  EXPECT_FALSE(guard_.admits(kOtherPort, data_, 500 + kSilence)) << "silence alone admits nobody";
  EXPECT_TRUE(guard_.admits(kHost, data_, 500 + kSilence)) << "nor does it shut the peer out";
  EXPECT_TRUE(guard_.admits(kOtherPort, hello_, 500 + 2 * kSilence));
  EXPECT_FALSE(guard_.admits(kHost, data_, 501 + 2 * kSilence));
}

TEST_F(SessionGuardTest, AfterAResetThePeerIsHeardAgainWithoutAHello) {
  guard_.resume(kHost, 100);
  EXPECT_TRUE(guard_.admits(kHost, data_, 101));
  EXPECT_FALSE(guard_.admits(kOtherPort, hello_, 102));
  EXPECT_TRUE(guard_.admits(kOtherPort, hello_, 101 + kSilence));
}

}  // namespace

}  // namespace vbar::boards::zynq7000
