// The same inputs give the same outputs, bit for bit, whatever the flight computer is and however it is connected.

#include <cstdint>
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include "host_sim/io/byte_channel.h"
#include "host_sim/io/child_process.h"
#include "host_sim/io/udp_socket.h"
#include "pil_bridge/remote_computer.h"
#include "pil_bridge/step_barrier.h"
#include "pil_bridge/transport.h"
#include "tests/integration/flight_computers/echo_computer.h"
#include "tests/support/paths.h"

namespace vbar::pil {

namespace {

using io::adopt_pty;
using io::adopt_socket;
using io::bind_udp_loopback;
using io::ChildProcess;
using io::FileDescriptor;
using io::make_pty;
using io::make_socket_pair;
using io::Pty;
using test::echo_options;
using test::expected_outputs;
using testing::HasSubstr;
using vbar::test::fly;

constexpr std::uint32_t kSteps = 200;

struct Connection {
  const char* name;
  Target target;
  LinkKind link;
};
class EveryTransport : public testing::TestWithParam<Connection> {};

TEST_P(EveryTransport, GivesTheSamePackets) {
  const auto options = echo_options(GetParam().target, GetParam().link);
  if (!test::has_image(options)) GTEST_SKIP() << options.image << " is not built";
  const auto computer = make_flight_computer(options);
  EXPECT_EQ(fly(*computer, kSteps), expected_outputs(kSteps));
  const LinkStatistics statistics = computer->statistics();
  EXPECT_GT(statistics.bytes_sent, 0U);
  EXPECT_GT(statistics.bytes_received, 0U);
  EXPECT_EQ(statistics.frames_rejected, 0U);
  computer->close();
}

INSTANTIATE_TEST_SUITE_P(FlightComputers, EveryTransport,
                         testing::Values(Connection{"HostProcessSerial", Target::kHostProcess, LinkKind::kSerial},
                                         Connection{"HostProcessPty", Target::kHostProcess, LinkKind::kPty},
                                         Connection{"HostProcessUdp", Target::kHostProcess, LinkKind::kUdp},
                                         Connection{"ArmLinuxSerial", Target::kZynqLinuxQemu, LinkKind::kSerial},
                                         Connection{"ArmLinuxPty", Target::kZynqLinuxQemu, LinkKind::kPty},
                                         Connection{"ArmLinuxUdp", Target::kZynqLinuxQemu, LinkKind::kUdp}),
                         [](const auto& tested) { return tested.param.name; });

TEST(FlightComputers, ReportStackAndName) {
  const auto computer = make_flight_computer(echo_options(Target::kHostProcess, LinkKind::kSerial));
  EXPECT_EQ(computer->description(), "host_process over serial: host process");
  const StepResult result = computer->step(0, vbar::test::step_packets(0, 1));
  EXPECT_TRUE(result.report.present);
  EXPECT_EQ(result.report.unit, "none");
  // The exerciser alone holds a payload and a packet on its stack; and it cannot have used more than the stack has.
  EXPECT_GT(result.report.stack_bytes, 2U * 1300U);
  EXPECT_LT(result.report.stack_bytes, 64U * 1024U);
  EXPECT_GT(result.compute_wall_s, 0.0);
}

TEST(FlightComputers, AStepAfterCloseIsAnError) {
  const auto computer = make_flight_computer(echo_options(Target::kHostProcess, LinkKind::kSerial));
  computer->close();
  computer->close();
  EXPECT_THROW((void)computer->step(0, vbar::test::step_packets(0, 1)), FlightComputerError);
}

// ---- a flight computer that is there already, as hardware would be

TEST(Board, OnASerialDevice) {
  Pty pty = make_pty();
  std::vector<FileDescriptor> inherited;
  inherited.push_back(std::move(pty.master));
  const ChildProcess board({vbar::tests::build_path("vbar_flight_echo"), "--stream", "3"}, std::move(inherited));
  auto options = echo_options(Target::kBoard, LinkKind::kSerial);
  options.endpoint = pty.slave_path;
  EXPECT_EQ(fly(*make_flight_computer(options), kSteps), expected_outputs(kSteps));
}

// The other way round: the flight software opens the device, by name and rate.
TEST(Board, OpensItsSerialDeviceItself) {
  Pty pty = make_pty();
  const ChildProcess board(
      {vbar::tests::build_path("vbar_flight_echo"), "--serial", pty.slave_path, "--baud", "115200"}, {});
  StreamTransport line(adopt_pty(std::move(pty.master), "pseudo-terminal"));
  StepBarrier barrier(line, 1, BarrierTiming{}, [] {});
  EXPECT_EQ(barrier.connect(test::kSpacecraft), "host process");
}

TEST(Board, OnUdpAnswersWhoeverSaysHelloAndIsReadyForTheNextRun) {
  const std::uint16_t port = bind_udp_loopback().port;
  const std::string address = "127.0.0.1:" + std::to_string(port);
  const ChildProcess board({vbar::tests::build_path("vbar_flight_echo"), "--udp", address}, {});
  auto options = echo_options(Target::kBoard, LinkKind::kUdp);
  options.endpoint = address;
  const auto first = fly(*make_flight_computer(options), kSteps);
  const auto second = fly(*make_flight_computer(options), kSteps);  // from another port, in another session
  EXPECT_EQ(first, expected_outputs(kSteps));
  EXPECT_EQ(second, first);
}

TEST(Board, ThatIsNotThereIsAnErrorAfterABoundedTime) {
  auto options = echo_options(Target::kBoard, LinkKind::kUdp);
  options.endpoint = "127.0.0.1:" + std::to_string(bind_udp_loopback().port);
  options.timing.boot_limit = std::chrono::milliseconds(200);
  const auto start = Clock::now();
  try {
    (void)make_flight_computer(options);
    FAIL();
  } catch (const FlightComputerError& error) {
    EXPECT_THAT(error.what(),
                HasSubstr("board over udp at " + options.endpoint + " failed while starting: no answer to hello"));
  }
  EXPECT_LT(Clock::now() - start, std::chrono::seconds(5));
}

// ---- the program itself

int exit_status_of(const std::vector<std::string>& arguments, std::string& output) {
  std::vector<std::string> all{vbar::tests::build_path("vbar_flight_echo")};
  all.insert(all.end(), arguments.begin(), arguments.end());
  ChildProcess program(all, {});
  if (!program.wait_for_end(std::chrono::seconds(10))) return -1;
  output = program.output_tail();
  return program.status_text() == "exit status 0" ? 0 : std::stoi(program.status_text().substr(12));
}

TEST(FlightProgram, ExplainsItselfWhenItsCommandLineMakesNoSense) {
  std::string output;
  for (const std::vector<std::string>& arguments : std::vector<std::vector<std::string>>{
           {}, {"--help"}, {"--serial"}, {"--udp", "127.0.0.1:5000", "--stream", "3"}, {"--baud", "9600"}}) {
    EXPECT_EQ(exit_status_of(arguments, output), 2);
    EXPECT_THAT(output, HasSubstr("usage:"));
  }
}

TEST(FlightProgram, SaysWhatItCouldNotOpen) {
  std::string output;
  EXPECT_EQ(exit_status_of({"--serial", "/nowhere/tty"}, output), 1);
  EXPECT_THAT(output, HasSubstr("/nowhere/tty: No such file or directory"));
  EXPECT_EQ(exit_status_of({"--serial", "/dev/null", "--baud", "12345"}, output), 1);
  EXPECT_THAT(output, HasSubstr("Invalid argument"));
  EXPECT_EQ(exit_status_of({"--unix", "/nowhere/socket"}, output), 1);
  EXPECT_EQ(exit_status_of({"--udp", "127.0.0.1:70000"}, output), 1);
  EXPECT_EQ(exit_status_of({"--stream", "9"}, output), 1);
}

TEST(FlightProgram, EndsWhenItsHostIsGone) {
  auto [ours, theirs] = make_socket_pair();
  std::vector<FileDescriptor> inherited;
  inherited.push_back(std::move(theirs));
  ChildProcess program({vbar::tests::build_path("vbar_flight_echo"), "--stream", "3"}, std::move(inherited));
  EXPECT_FALSE(program.wait_for_end(std::chrono::milliseconds(20)));
  ours.reset();
  EXPECT_TRUE(program.wait_for_end(std::chrono::seconds(10)));
  EXPECT_EQ(program.status_text(), "exit status 0");
}

TEST(FlightProgram, EndsWhenItsTerminalHangsUp) {
  Pty pty = make_pty();
  std::vector<FileDescriptor> inherited;
  inherited.push_back(std::move(pty.slave));
  ChildProcess program({vbar::tests::build_path("vbar_flight_echo"), "--stream", "3"}, std::move(inherited));
  EXPECT_FALSE(program.wait_for_end(std::chrono::milliseconds(20)));
  pty.master.reset();
  EXPECT_TRUE(program.wait_for_end(std::chrono::seconds(10)));
  EXPECT_EQ(program.status_text(), "exit status 0");
}

}  // namespace

// The bare-metal image on the emulated Zynq-7000: the same bits as a call in this process, over its UART and its
// Ethernet, a cost in instructions that no circumstance changes, and nothing left behind when it dies.

namespace {

using testing::AllOf;
using vbar::test::packet_count;
using vbar::test::step_packets;

constexpr std::uint32_t kEmulatorSteps = 8;  // one of them takes more than a window of packets

struct Flight {
  std::vector<Packet> outputs;
  std::vector<std::uint64_t> instructions;  ///< of each step
  std::string unit;
  std::uint32_t stack_bytes = 0;
  LinkStatistics statistics;
};

Flight fly_emulated(const FlightComputerOptions& options) {
  const auto computer = make_flight_computer(options);
  Flight flight;
  for (std::uint32_t step = 0; step < kEmulatorSteps; ++step) {
    const auto result = computer->step(step, step_packets(step, packet_count(step)));
    flight.outputs.insert(flight.outputs.end(), result.packets.begin(), result.packets.end());
    flight.instructions.push_back(result.report.count);
    flight.unit = result.report.unit;
    flight.stack_bytes = result.report.stack_bytes;
  }
  flight.statistics = computer->statistics();
  computer->close();
  return flight;
}

class Emulator : public testing::Test {
 protected:
  void SetUp() override {
    if (!test::has_image(echo_options(Target::kZynqQemu, LinkKind::kSerial))) {
      GTEST_SKIP() << "build/zynq/vbar_zynq7000_echo.elf is not built";
    }
  }
};

TEST_F(Emulator, GivesTheSamePacketsAndTheSameCostOverUartAndEthernet) {
  const Flight uart = fly_emulated(echo_options(Target::kZynqQemu, LinkKind::kSerial));
  const Flight ethernet = fly_emulated(echo_options(Target::kZynqQemu, LinkKind::kUdp));
  EXPECT_EQ(uart.outputs, expected_outputs(kEmulatorSteps));
  EXPECT_EQ(ethernet.outputs, uart.outputs);
  EXPECT_EQ(uart.unit, "instructions");
  EXPECT_EQ(ethernet.instructions, uart.instructions);
  // A payload and a packet are on the exerciser's stack; all of the board's stack is 1 MiB.
  EXPECT_GT(uart.stack_bytes, 2U * 1300U);
  EXPECT_LT(uart.stack_bytes, 64U * 1024U);
  EXPECT_EQ(uart.statistics.frames_rejected, 0U);
}

// Emulated time a number of times slower: the timer counts more ticks, for the same instructions.
TEST_F(Emulator, CountsTheSameInstructionsAtAnotherClock) {
  auto options = echo_options(Target::kZynqQemu, LinkKind::kUdp);
  const Flight usual = fly_emulated(options);
  options.icount_shift = kGreatestIcountShift;
  const Flight slower = fly_emulated(options);
  EXPECT_EQ(slower.outputs, usual.outputs);
  EXPECT_EQ(slower.instructions, usual.instructions);
}

// About 50 kB pass the UART in each direction; one byte in 10,000 is hit.
TEST_F(Emulator, ABadSerialLineChangesNoPacket) {
  auto options = echo_options(Target::kZynqQemu, LinkKind::kSerial);
  options.faults = {.seed = 6, .flip_bit_per_byte = 5e-5, .drop_byte_per_byte = 5e-5};
  options.timing.poll_after = std::chrono::milliseconds(200);
  const Flight bad = fly_emulated(options);
  EXPECT_EQ(bad.outputs, expected_outputs(kEmulatorSteps));
  EXPECT_GT(bad.statistics.frames_rejected, 0U);
  EXPECT_GT(bad.statistics.frames_resent, 0U);
}

TEST_F(Emulator, KilledInMidRunIsOneClearError) {
  const auto computer = make_flight_computer(echo_options(Target::kZynqQemu, LinkKind::kSerial));
  const int pid = dynamic_cast<RemoteComputer&>(*computer).process_id();
  (void)computer->step(0, step_packets(0, 1));
  ASSERT_EQ(::kill(pid, SIGKILL), 0);
  try {
    (void)computer->step(1, step_packets(1, 1));
    FAIL();
  } catch (const FlightComputerError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("flight computer zynq_qemu over serial failed at step 1: "),
                                    HasSubstr("qemu-system-arm: killed by signal 9 (Killed)")));
  }
  EXPECT_NE(::kill(pid, 0), 0);
}

TEST_F(Emulator, AnImageThatNeverAnswersIsGivenUp) {
  auto options = echo_options(Target::kZynqQemu, LinkKind::kSerial);
  // An ELF header and a program header of 4 bytes: an endless loop.
  const std::string file = testing::TempDir() + "vbar_endless_loop_" + std::to_string(::getpid());
  const auto word = [](std::uint32_t value) { return std::string(reinterpret_cast<const char*>(&value), 4); };
  std::ofstream(file, std::ios::binary) << std::string(
                                               "\x7f"
                                               "ELF\1\1\1\0\0\0\0\0\0\0\0\0\2\0\x28\0",
                                               20)
                                        << word(1) << word(84) << word(52) << word(0) << word(0x5000000)
                                        << word(52 | 32 << 16) << word(1 | 40 << 16) << word(0)  // of the file
                                        << word(1) << word(84) << word(84) << word(84) << word(4) << word(4) << word(5)
                                        << word(4)            // of the program
                                        << word(0xeafffffe);  // b .
  options.image = file;
  options.timing.boot_limit = std::chrono::milliseconds(500);
  try {
    (void)make_flight_computer(options);
    FAIL();
  } catch (const FlightComputerError& error) {
    EXPECT_THAT(error.what(), HasSubstr("failed while starting: "));
  }
  std::filesystem::remove(file);
}

}  // namespace

}  // namespace vbar::pil
