// The host's side of a receiver that is wired to the flight computer: when a step may begin, and what the recorded
// inputs are.

#include <array>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fsw/packets/messages.h"
#include "host_sim/io/byte_channel.h"
#include "pil_bridge/remote_computer.h"

namespace vbar::pil {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

constexpr milliseconds kLimit{30};

/// A receiver and a flight computer as two counters.
struct Line {
  std::uint64_t sent = 0;
  std::uint64_t arrived = 0;
  int questions = 0;

  io::WiredReceiver receiver() {
    return {.device = "", .baud = 115200, .in_lock_step = true, .bytes_sent = [this] { return sent; }};
  }
  /// Each question lets `each` bytes more arrive, up to what was sent less `lost`.
  WiredBytes::AskCount ask(std::uint64_t each, std::uint64_t lost = 0) {
    return [this, each, lost](Clock::time_point) -> std::optional<std::uint64_t> {
      ++questions;
      if (arrived + lost < sent) arrived = std::min(arrived + each, sent - lost);
      return arrived;
    };
  }
};

TEST(WiredBytes, WaitsUntilAllThatWasSentHasArrived) {
  Line line;
  line.sent = 500;  // before the flight computer was there
  WiredBytes wired(line.receiver(), kLimit);
  line.sent += 100;
  int questions = 0;
  std::uint64_t arrived = 0;
  wired.wait([&](Clock::time_point) -> std::optional<std::uint64_t> {
    ++questions;
    if (questions % 2 == 0) return std::nullopt;  // a lost answer is asked for again
    return arrived += 40;
  });
  EXPECT_EQ(arrived, 120U);  // more than was sent does not stop it either
  EXPECT_EQ(wired.statistics().timeouts, 0U);
  EXPECT_EQ(wired.statistics().missing, 0U);
}

// Lost bytes cost one wait, are counted once, and the next step waits for its own bytes only.
TEST(WiredBytes, LostBytesAreBookedOnceAndDoNotStopTheRun) {
  Line line;
  WiredBytes wired(line.receiver(), kLimit);
  line.sent = 1000;
  const auto start = Clock::now();
  wired.wait(line.ask(300, 7));
  EXPECT_GE(Clock::now() - start, kLimit);
  EXPECT_EQ(wired.statistics().timeouts, 1U);
  EXPECT_EQ(wired.statistics().missing, 7U);
  line.sent = 2000;
  line.questions = 0;
  wired.wait(line.ask(500, 7));
  EXPECT_EQ(line.questions, 2);
  EXPECT_EQ(wired.statistics().timeouts, 1U);
  EXPECT_EQ(wired.statistics().missing, 7U);
}

// On a busy computer an emulated board is slow, and nothing is lost.
TEST(WiredBytes, ASlowFlightComputerIsWaitedForBeyondTheLimit) {
  Line line;
  WiredBytes wired(line.receiver(), kLimit);
  line.sent = 300;
  wired.wait([&](Clock::time_point) -> std::optional<std::uint64_t> {
    std::this_thread::sleep_for(kLimit / 3);
    if (++line.questions % 2 == 0) return std::nullopt;
    return line.arrived += 30;
  });
  EXPECT_EQ(line.arrived, line.sent);
  // A pause of more than the limit, in which it answers but rarely.
  line.sent += 30;
  line.questions = 0;
  wired.wait([&](Clock::time_point) -> std::optional<std::uint64_t> {
    std::this_thread::sleep_for(kLimit / 2);
    return line.arrived += ++line.questions == 8 ? 30 : 0;
  });
  EXPECT_EQ(line.arrived, line.sent);
  EXPECT_EQ(wired.statistics().timeouts, 0U);
}

TEST(WiredBytes, AFlightComputerThatDoesNotAnswerDoesNotStopIt) {
  Line line;
  WiredBytes wired(line.receiver(), kLimit);
  line.sent = 10;
  wired.wait([](Clock::time_point) { return std::optional<std::uint64_t>(); });
  EXPECT_EQ(wired.statistics().timeouts, 1U);
  EXPECT_EQ(wired.statistics().missing, 10U);
}

// Not counted, or not counted in time: what has left the terminal of the receiver has arrived.
TEST(WiredBytes, WaitsUntilTheTerminalOfTheReceiverIsEmpty) {
  io::Pty pty = io::make_pty();
  const auto receiver = io::adopt_pty(std::move(pty.master), "the receiver's line");
  const auto flight_computer = io::open_serial(pty.slave_path, 115200);
  for (const bool counts : {false, true}) {
    io::WiredReceiver line{.device = pty.slave_path, .in_lock_step = true};
    if (counts) line.bytes_sent = [] { return std::uint64_t{0}; };
    WiredBytes wired(line, std::chrono::seconds(20));
    const std::vector<std::uint8_t> bytes(3000, 5);
    receiver->write(bytes, Clock::now() + std::chrono::seconds(20));
    std::uint64_t arrived = 0;
    int questions = 0;
    wired.wait([&](Clock::time_point) -> std::optional<std::uint64_t> {
      if (++questions % 3 == 0) arrived += flight_computer->read(Clock::now() + kLimit).size();
      return arrived;
    });
    EXPECT_EQ(arrived, bytes.size());
    EXPECT_EQ(wired.statistics().timeouts, 0U);
  }
}

TEST(WiredBytes, ATerminalThatNobodyReadsDoesNotStopIt) {
  io::Pty pty = io::make_pty();
  const auto receiver = io::adopt_pty(std::move(pty.master), "the receiver's line");
  WiredBytes wired({.device = pty.slave_path, .in_lock_step = true}, kLimit);
  receiver->write(std::vector<std::uint8_t>(10), Clock::now() + std::chrono::seconds(20));
  const auto none = [](Clock::time_point) { return std::optional<std::uint64_t>(0); };
  wired.wait(none);
  EXPECT_EQ(wired.statistics().timeouts, 1U);
  // Hung up, it holds nothing.
  WiredBytes nowhere({.device = "/nowhere/tty", .in_lock_step = true}, kLimit);
  nowhere.wait(none);
  EXPECT_EQ(nowhere.statistics().timeouts, 0U);
}

TEST(WiredBytes, InRealTimeNothingIsWaitedFor) {
  WiredBytes wired({.device = "", .bytes_sent = [] { return std::uint64_t{99}; }}, kLimit);
  wired.wait([](Clock::time_point) -> std::optional<std::uint64_t> {
    ADD_FAILURE();
    return 0;
  });
  EXPECT_EQ(wired.statistics().timeouts, 0U);
}

template <class Message>
Packet packet_of(const Message& message) {
  fsw::packets::PacketHeader header;
  header.time.ns = 1'400'000'000'123'456'789;
  header.spacecraft = 3;
  header.sequence_count = 77;
  Packet packet(fsw::packets::kMaxPacketBytes);
  packet.resize(fsw::packets::encode(header, message, packet).value());
  return packet;
}

TEST(WiredBytes, TheMirrorBecomesTheInputThatTheFlightSoftwareWasGiven) {
  WiredBytes wired({}, kLimit);
  wired_bytes mirror{};
  mirror.received = 5000;
  mirror.dropped = 12;
  mirror.count = 1280;
  gnss_bytes input{};
  input.count = mirror.count;
  for (std::size_t k = 0; k < sizeof mirror.data; ++k)
    mirror.data[k] = input.data[k] = static_cast<std::uint8_t>(k * 7U);
  EXPECT_EQ(wired.take(packet_of(mirror)), packet_of(input));
  EXPECT_EQ(wired.statistics().bytes, 1280U);
  EXPECT_EQ(wired.statistics().dropped, 12U);
  EXPECT_EQ(wired.take(packet_of(telemetry_health{})), std::nullopt);
  EXPECT_EQ(wired.take(Packet{1, 2, 3}), std::nullopt);
}

std::string error_of(const Packet& packet) {
  WiredBytes wired({}, kLimit);
  try {
    (void)wired.take(packet);
  } catch (const LinkError& error) {
    return error.what();
  }
  return "no error";
}

TEST(WiredBytes, AnInvalidMirrorIsOneClearError) {
  wired_bytes mirror{};
  for (const std::int32_t count : {-1, 0, 1281, INT32_MAX}) {
    mirror.count = count;
    EXPECT_THAT(error_of(packet_of(mirror)), HasSubstr("with " + std::to_string(count) + " bytes")) << count;
  }
  mirror.count = 1;
  mirror.dropped = -1;
  EXPECT_THAT(error_of(packet_of(mirror)), HasSubstr("-1 dropped"));
  // A message of another type under its APID.
  fsw::packets::PacketHeader header;
  header.apid = fsw::packets::Apid::kWiredBytes;
  const std::array<std::uint8_t, 40> other{};
  Packet packet(fsw::packets::kMaxPacketBytes);
  packet.resize(fsw::packets::write_packet(header, other, packet).value());
  EXPECT_THAT(error_of(packet), HasSubstr("not one of this version"));
}

}  // namespace
}  // namespace vbar::pil
