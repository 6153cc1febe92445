// A receiver that is wired to the flight computer: what a program writes to a terminal reaches the flight software in
// the step before whose tick it was sent, and the recorded inputs give the same output on any other flight computer.

#include <random>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <termios.h>

#include "host_sim/io/byte_channel.h"
#include "host_sim/io/child_process.h"
#include "host_sim/io/udp_socket.h"
#include "tests/integration/flight_computers/echo_computer.h"
#include "tests/support/paths.h"

namespace vbar::pil {
namespace {

using test::echo_options;
using testing::HasSubstr;
using vbar::test::packet_count;
using vbar::test::step_packets;

constexpr std::chrono::seconds kWritePatienceOfTest{20};

/// A receiver that sends random bytes on a pseudo-terminal.
class Receiver {
 public:
  explicit Receiver(unsigned baud = 115200) : baud_(baud) {
    io::Pty pty = io::make_pty();
    device_ = pty.slave_path;
    held_open_ = std::move(pty.slave);
    line_ = io::adopt_pty(std::move(pty.master), "the receiver's line");
  }

  void send(std::size_t size) {
    std::vector<std::uint8_t> bytes(size);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random_() >> 56U);
    line_->write(bytes, Clock::now() + kWritePatienceOfTest);
    count_ += size;
    sent_.insert(sent_.end(), bytes.begin(), bytes.end());
  }
  /// What was sent so far is of no interest.
  void forget() { sent_.clear(); }
  /// Bytes that it claims to have sent and that never arrive.
  void lose(std::uint64_t bytes) { count_ += bytes; }

  [[nodiscard]] io::WiredReceiver wired() {
    return {.device = device_, .baud = baud_, .in_lock_step = true, .bytes_sent = [this] { return count_; }};
  }
  /// The rate that the other end of the line has set.
  [[nodiscard]] speed_t rate() const {
    termios settings{};
    EXPECT_EQ(::tcgetattr(held_open_.get(), &settings), 0);
    return ::cfgetispeed(&settings);
  }
  [[nodiscard]] const std::vector<std::uint8_t>& sent() const { return sent_; }

 private:
  unsigned baud_;
  std::string device_;
  io::FileDescriptor held_open_;  ///< so that the line does not hang up between two flight computers
  std::unique_ptr<io::ByteChannel> line_;
  std::mt19937_64 random_{7};
  std::vector<std::uint8_t> sent_;
  std::uint64_t count_ = 0;
};

/// Bytes of the receiver in each step: none, a few, up to several packets.
std::size_t bytes_of(std::uint32_t step) {
  return step % 5 == 3 ? 0 : step % 7 == 2 ? 9000 : 1 + 611U * (step % 6);
}

struct Flight {
  std::vector<std::vector<Packet>> inputs;  ///< of each step, those of the receiver included
  std::vector<Packet> outputs;
  std::vector<std::uint8_t> wired;  ///< content of the receiver's packets
  speed_t rate = B0;                ///< of the line, as the flight computer set it
  LinkStatistics statistics;
};

Flight fly_wired(const FlightComputerOptions& options, Receiver& receiver, std::uint32_t steps) {
  const auto computer = make_flight_computer(options);
  Flight flight;
  for (std::uint32_t step = 0; step < steps; ++step) {
    receiver.send(bytes_of(step));
    std::vector<Packet> inputs = step_packets(step, packet_count(step));
    const StepResult result = computer->step(step, inputs);
    for (const Packet& packet : result.wired) {
      const auto view = fsw::packets::parse_packet(packet).value();
      EXPECT_EQ(view.header.time.ns, vbar::test::kFirstStepNs + step * vbar::test::kStepPeriodNs);
      EXPECT_EQ(view.header.spacecraft, test::kSpacecraft);
      const auto message = fsw::packets::decode<gnss_bytes>(view).value();
      flight.wired.insert(flight.wired.end(), message.data, message.data + message.count);
    }
    inputs.insert(inputs.end() - 1, result.wired.begin(), result.wired.end());
    flight.inputs.push_back(std::move(inputs));
    flight.outputs.insert(flight.outputs.end(), result.packets.begin(), result.packets.end());
    EXPECT_EQ(flight.wired.size(), receiver.sent().size()) << "step " << step << " began before all bytes had arrived";
  }
  flight.statistics = computer->statistics();
  flight.rate = receiver.rate();
  computer->close();
  return flight;
}

/// The recorded inputs, given to the flight software in this process.
std::vector<Packet> replayed(const Flight& flight) {
  const auto computer = make_flight_computer(echo_options(Target::kInProcess, LinkKind::kSerial));
  std::vector<Packet> outputs;
  for (std::uint32_t step = 0; step < flight.inputs.size(); ++step) {
    const auto result = computer->step(step, flight.inputs[step]);
    outputs.insert(outputs.end(), result.packets.begin(), result.packets.end());
  }
  return outputs;
}

struct Connection {
  const char* name;
  Target target;
  LinkKind link;
  std::uint32_t steps;
};
class EveryWiredReceiver : public testing::TestWithParam<Connection> {};

TEST_P(EveryWiredReceiver, BytesOnTheLineAreInputsOfTheirStepAndReplayable) {
  auto options = echo_options(GetParam().target, GetParam().link);
  if (!test::has_image(options)) GTEST_SKIP() << options.image << " is not built";
  Receiver receiver(57600);
  receiver.send(100);  // before the flight computer is there: discarded
  receiver.forget();
  options.receiver = receiver.wired();
  const Flight flight = fly_wired(options, receiver, GetParam().steps);
  EXPECT_EQ(flight.rate, speed_t{B57600});
  EXPECT_EQ(flight.wired, receiver.sent());
  EXPECT_EQ(flight.outputs, replayed(flight));
  EXPECT_EQ(flight.statistics.wired.bytes, receiver.sent().size());
  EXPECT_EQ(flight.statistics.wired.timeouts, 0U);
  EXPECT_EQ(flight.statistics.wired.dropped, 0U);
  EXPECT_EQ(flight.statistics.frames_rejected, 0U);
}

// A receiver that does not count what it sends: its terminal shows when everything has arrived.
TEST_P(EveryWiredReceiver, IsWaitedForWithoutACountAsWell) {
  auto options = echo_options(GetParam().target, GetParam().link);
  if (!test::has_image(options)) GTEST_SKIP() << options.image << " is not built";
  Receiver receiver;
  options.receiver = receiver.wired();
  options.receiver->bytes_sent = {};
  const Flight flight = fly_wired(options, receiver, GetParam().steps);
  EXPECT_EQ(flight.wired, receiver.sent());
  EXPECT_EQ(flight.statistics.wired.timeouts, 0U);
}

INSTANTIATE_TEST_SUITE_P(FlightComputers, EveryWiredReceiver,
                         testing::Values(Connection{"HostProcessSerial", Target::kHostProcess, LinkKind::kSerial, 100},
                                         Connection{"HostProcessPty", Target::kHostProcess, LinkKind::kPty, 100},
                                         Connection{"HostProcessUdp", Target::kHostProcess, LinkKind::kUdp, 100},
                                         Connection{"ArmLinuxSerial", Target::kZynqLinuxQemu, LinkKind::kSerial, 50},
                                         Connection{"ArmLinuxUdp", Target::kZynqLinuxQemu, LinkKind::kUdp, 50},
                                         Connection{"ZynqUdp", Target::kZynqQemu, LinkKind::kUdp, 30}),
                         [](const auto& tested) { return tested.param.name; });

// Frames of the link that are lost, repeated or late have no effect on the bytes of the receiver.
TEST(WiredReceiver, ABadLinkChangesNothing) {
  auto options = echo_options(Target::kHostProcess, LinkKind::kUdp);
  options.faults = {
      .seed = 8, .flip_bit_per_frame = 0.02, .drop_frame = 0.02, .duplicate_frame = 0.02, .delay_frame = 0.02};
  options.timing.poll_after = std::chrono::milliseconds(5);
  options.timing.poll_limit = std::chrono::milliseconds(40);
  options.timing.hello_period = std::chrono::milliseconds(20);
  Receiver receiver;
  options.receiver = receiver.wired();
  const Flight flight = fly_wired(options, receiver, 60);
  EXPECT_EQ(flight.wired, receiver.sent());
  EXPECT_EQ(flight.outputs, replayed(flight));
  EXPECT_EQ(flight.statistics.wired.timeouts, 0U);
  EXPECT_GT(flight.statistics.frames_rejected, 0U);
}

// A line that loses bytes costs the limit once, not at every step.
TEST(WiredReceiver, BytesLostOnTheLineAreBookedAndDoNotStopTheRun) {
  auto options = echo_options(Target::kHostProcess, LinkKind::kSerial);
  options.timing.wired_limit = std::chrono::milliseconds(100);
  Receiver receiver;
  options.receiver = receiver.wired();
  const auto computer = make_flight_computer(options);
  const auto start = Clock::now();
  std::size_t arrived = 0;
  for (std::uint32_t step = 0; step < 20; ++step) {
    receiver.send(500);
    if (step == 4) receiver.lose(33);
    for (const Packet& packet : computer->step(step, step_packets(step, 1)).wired)
      arrived += static_cast<std::size_t>(
          fsw::packets::decode<gnss_bytes>(fsw::packets::parse_packet(packet).value()).value().count);
    EXPECT_EQ(arrived, receiver.sent().size());
  }
  EXPECT_GE(Clock::now() - start, options.timing.wired_limit);
  EXPECT_EQ(computer->statistics().wired.timeouts, 1U);
  EXPECT_EQ(computer->statistics().wired.missing, 33U);
}

TEST(WiredReceiver, ADeviceThatDoesNotExistIsOneClearError) {
  auto options = echo_options(Target::kHostProcess, LinkKind::kSerial);
  options.receiver = io::WiredReceiver{.device = "/nowhere/tty"};
  try {
    (void)make_flight_computer(options);
    FAIL();
  } catch (const FlightComputerError& error) {
    EXPECT_THAT(error.what(), HasSubstr("no line to a receiver at this rate"));
  }
}

// A program that runs already, as a board does: its command line names the device.
TEST(WiredReceiver, OfABoardHasTheDeviceOfTheBoard) {
  const std::uint16_t port = io::bind_udp_loopback().port;
  const std::string address = "127.0.0.1:" + std::to_string(port);
  Receiver receiver(38400);
  const io::ChildProcess board(
      {vbar::tests::build_path("vbar_flight_echo"), "--udp", address, "--receiver", receiver.wired().device}, {});
  auto options = echo_options(Target::kBoard, LinkKind::kUdp);
  options.endpoint = address;
  options.receiver = receiver.wired();
  options.receiver->device.clear();  // unknown to this program
  const Flight flight = fly_wired(options, receiver, 10);
  EXPECT_EQ(flight.wired, receiver.sent());
  EXPECT_EQ(flight.outputs, replayed(flight));
}

}  // namespace
}  // namespace vbar::pil
