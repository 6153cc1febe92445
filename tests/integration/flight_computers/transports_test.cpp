// The same inputs give the same outputs, bit for bit, whatever the flight computer is and however it is connected.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host_sim/io/byte_channels.h"
#include "host_sim/io/child_process.h"
#include "host_sim/io/udp_socket.h"
#include "pil_bridge/step_barrier.h"
#include "pil_bridge/stream_transport.h"
#include "pil_bridge/udp_transport.h"
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
}  // namespace vbar::pil
