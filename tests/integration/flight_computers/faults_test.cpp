// A bad line and a flight computer that dies, with a real process at the other end.

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "fsw/packets/messages.h"
#include "host_sim/io/child_process.h"
#include "host_sim/io/udp_socket.h"
#include "pil_bridge/remote_computer.h"
#include "pil_bridge/transport.h"
#include "tests/integration/flight_computers/echo_computer.h"
#include "tests/support/paths.h"

namespace vbar::pil {

namespace {

using std::chrono::milliseconds;
using test::echo_options;
using test::expected_outputs;
using testing::AllOf;
using testing::HasSubstr;
using vbar::test::fly;
using vbar::test::packet_count;
using vbar::test::step_packets;

constexpr std::uint32_t kSteps = 60;

FlightComputerOptions bad_line(LinkKind link, const LinkFaults& faults) {
  auto options = echo_options(Target::kHostProcess, link);
  options.faults = faults;
  // A local process answers in well under a millisecond: what is silent for longer was lost.
  options.timing.poll_after = milliseconds(5);
  options.timing.poll_limit = milliseconds(40);
  options.timing.hello_period = milliseconds(20);
  return options;
}

struct Flight {
  std::vector<Packet> outputs;
  LinkStatistics statistics;
};
Flight fly_over(const FlightComputerOptions& options) {
  const auto computer = make_flight_computer(options);
  return {fly(*computer, kSteps), computer->statistics()};
}

// About 280 kB pass the line in each direction; one byte in 10,000 is hit.
TEST(BadSerialLine, FlippedBitsAreRejectedAndSentAgain) {
  const Flight flight = fly_over(bad_line(LinkKind::kSerial, {.seed = 1, .flip_bit_per_byte = 1e-4}));
  EXPECT_EQ(flight.outputs, expected_outputs(kSteps));
  EXPECT_GT(flight.statistics.frames_rejected, 0U);
  EXPECT_GT(flight.statistics.frames_resent, 0U);
}

TEST(BadSerialLine, DroppedBytesAreRejectedAndSentAgain) {
  const Flight flight = fly_over(bad_line(LinkKind::kPty, {.seed = 2, .drop_byte_per_byte = 1e-4}));
  EXPECT_EQ(flight.outputs, expected_outputs(kSteps));
  EXPECT_GT(flight.statistics.frames_rejected, 0U);
  EXPECT_GT(flight.statistics.frames_resent, 0U);
}

TEST(BadSerialLine, DuplicatedFramesAreCountedAndDropped) {
  const Flight flight = fly_over(bad_line(LinkKind::kSerial, {.seed = 3, .duplicate_frame = 0.1}));
  EXPECT_EQ(flight.outputs, expected_outputs(kSteps));
  EXPECT_GT(flight.statistics.frames_duplicated, 0U);
}

TEST(BadSerialLine, AStalledLineIsPolledAndTheAnswerNotDoubled) {
  const Flight flight = fly_over(
      bad_line(LinkKind::kSerial, {.seed = 4, .drop_frame = 0.02, .stall_per_frame = 0.02, .stall = milliseconds(30)}));
  EXPECT_EQ(flight.outputs, expected_outputs(kSteps));
  EXPECT_GT(flight.statistics.polls, 0U);
  EXPECT_GT(flight.statistics.frames_resent, 0U);
}

TEST(BadNetwork, LostRepeatedAndLateDatagramsChangeNothing) {
  const Flight flight = fly_over(bad_line(
      LinkKind::kUdp,
      {.seed = 5, .flip_bit_per_frame = 0.02, .drop_frame = 0.02, .duplicate_frame = 0.02, .delay_frame = 0.02}));
  EXPECT_EQ(flight.outputs, expected_outputs(kSteps));
  EXPECT_GT(flight.statistics.frames_rejected, 0U);
  EXPECT_GT(flight.statistics.frames_resent, 0U);
  EXPECT_GT(flight.statistics.frames_duplicated, 0U);
}

TEST(SlowSerialLine, FliesAtTheRateOfItsBaud) {
  auto options = echo_options(Target::kHostProcess, LinkKind::kSerial);
  options.paced_bits_per_s = 3e6;
  const auto start = Clock::now();
  const auto computer = make_flight_computer(options);
  constexpr std::uint32_t kFew = 10;
  EXPECT_EQ(fly(*computer, kFew), expected_outputs(kFew));
  const LinkStatistics statistics = computer->statistics();
  // 10 bits a byte; the lines of the two directions are in use at the same time, at best.
  const double least_s =
      static_cast<double>(std::max(statistics.bytes_sent, statistics.bytes_received)) * 10.0 / options.paced_bits_per_s;
  EXPECT_GE(std::chrono::duration<double>(Clock::now() - start).count(), least_s);
}

// ---- foreign datagrams, at the board

TEST(Stranger, IsIgnoredAndCountedByTheBoard) {
  const std::uint16_t port = io::bind_udp_loopback().port;
  const std::string address = "127.0.0.1:" + std::to_string(port);
  const io::ChildProcess board({vbar::tests::build_path("vbar_flight_echo"), "--udp", address}, {});
  auto options = echo_options(Target::kBoard, LinkKind::kUdp);
  options.endpoint = address;
  const auto computer = make_flight_computer(options);
  const auto stranger = make_udp_transport("127.0.0.1", port);
  std::vector<Packet> outputs;
  for (std::uint32_t step = 0; step < kSteps; ++step) {
    stranger->send(std::vector<std::uint8_t>(100, static_cast<std::uint8_t>(step)));
    const auto result = computer->step(step, step_packets(step, packet_count(step)));
    outputs.insert(outputs.end(), result.packets.begin(), result.packets.end());
  }
  EXPECT_EQ(outputs, expected_outputs(kSteps));
  EXPECT_EQ(computer->statistics().frames_rejected, kSteps);
}

// ---- a flight computer that dies

std::string error_of_step(FlightComputer& computer, std::uint32_t step) {
  try {
    (void)computer.step(step, step_packets(step, packet_count(step)));
  } catch (const FlightComputerError& error) {
    return error.what();
  }
  return "no error";
}

bool exists(int pid) {
  return ::kill(pid, 0) == 0 || errno != ESRCH;
}

/// Makes a directory of its own the place for temporary files, so that what is left there is ours.
class PrivateTemporaryDirectory {
 public:
  PrivateTemporaryDirectory() {
    path_ = std::filesystem::temp_directory_path() / ("vbar_test_" + std::to_string(::getpid()));
    std::filesystem::create_directory(path_);
    ::setenv("TMPDIR", path_.c_str(), 1);
  }
  ~PrivateTemporaryDirectory() {
    ::unsetenv("TMPDIR");
    std::filesystem::remove_all(path_);
  }
  PrivateTemporaryDirectory(const PrivateTemporaryDirectory&) = delete;
  PrivateTemporaryDirectory& operator=(const PrivateTemporaryDirectory&) = delete;
  [[nodiscard]] bool is_empty() const { return std::filesystem::is_empty(path_); }

 private:
  std::filesystem::path path_;
};

class Killed : public testing::TestWithParam<LinkKind> {};

TEST_P(Killed, InMidRunIsOneClearErrorAndLeavesNothing) {
  const PrivateTemporaryDirectory temporary;
  int pid = -1;
  {
    auto options = echo_options(Target::kHostProcess, GetParam());
    options.timing.poll_after = milliseconds(20);
    const auto computer = make_flight_computer(options);
    pid = dynamic_cast<RemoteComputer&>(*computer).process_id();
    (void)fly(*computer, 3);
    ASSERT_EQ(::kill(pid, SIGKILL), 0);
    const auto start = Clock::now();
    const std::string error = error_of_step(*computer, 3);
    EXPECT_THAT(error, AllOf(HasSubstr("flight computer host_process over " + std::string(name_of(GetParam()))),
                             HasSubstr("failed at step 3: "), HasSubstr("killed by signal 9 (Killed)")));
    EXPECT_EQ(error.find('\n'), std::string::npos);
    EXPECT_LT(Clock::now() - start, std::chrono::seconds(5));  // far less than give_up_after: its death was noticed
    EXPECT_EQ(error_of_step(*computer, 4), error);
    EXPECT_FALSE(exists(pid));
  }
  EXPECT_TRUE(temporary.is_empty());
}

INSTANTIATE_TEST_SUITE_P(Links, Killed, testing::Values(LinkKind::kSerial, LinkKind::kPty, LinkKind::kUdp),
                         [](const auto& tested) { return std::string(name_of(tested.param)); });

// It still runs and holds its line, but never answers again.
TEST(Stopped, IsGivenUpAfterABoundedTimeAndEnded) {
  auto options = echo_options(Target::kHostProcess, LinkKind::kSerial);
  options.timing.poll_after = milliseconds(20);
  options.timing.give_up_after = milliseconds(300);
  const auto computer = make_flight_computer(options);
  const int pid = dynamic_cast<RemoteComputer&>(*computer).process_id();
  ASSERT_EQ(::kill(pid, SIGSTOP), 0);
  ASSERT_EQ(::waitpid(pid, nullptr, WUNTRACED), pid);  // all its threads have stopped
  EXPECT_THAT(error_of_step(*computer, 0),
              AllOf(HasSubstr("no answer to step 0 within 0.3 s"), HasSubstr("was still running and has been ended")));
  EXPECT_FALSE(exists(pid));
}

TEST(Crashed, WhileStartingTellsItsLastWords) {
  auto options = echo_options(Target::kHostProcess, LinkKind::kSerial);
  options.image = "/bin/ls";  // it does not know --stream
  try {
    (void)make_flight_computer(options);
    FAIL();
  } catch (const FlightComputerError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("failed while starting"), HasSubstr("exit status 2"),
                                    HasSubstr("its last output"), HasSubstr("--stream")));
  }
}

TEST(Interrupted, RunLeavesNoProcess) {
  int pid = -1;
  try {
    const auto computer = make_flight_computer(echo_options(Target::kHostProcess, LinkKind::kUdp));
    pid = dynamic_cast<RemoteComputer&>(*computer).process_id();
    throw std::runtime_error("the simulation found something impossible");
  } catch (const std::runtime_error&) {
  }
  EXPECT_FALSE(exists(pid));
}

}  // namespace

// The budget of a step and the watchdog of the bare-metal image on the emulated Zynq-7000, with a test article whose
// step at GPS time t takes t turns of a loop.

namespace {

constexpr std::uint64_t kBudget = 2'000'000;  // instructions
constexpr std::int64_t kShort = 1'000;        // turns of about ten instructions
constexpr std::int64_t kLong = 500'000;
constexpr std::int64_t kEndless = std::int64_t{1} << 60;

Packet tick_at(std::uint32_t step, std::int64_t gps_time_ns) {
  fsw::packets::PacketHeader header;
  header.time.ns = gps_time_ns;
  header.spacecraft = test::kSpacecraft;
  vbar::tick tick{};
  tick.step = step;
  tick.period_ns = 1;
  std::array<std::uint8_t, fsw::packets::kMaxPacketBytes> bytes{};
  const auto size = fsw::packets::encode(header, tick, bytes);
  return {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size.value())};
}

class Supervision : public testing::TestWithParam<LinkKind> {
 protected:
  void SetUp() override {
    options_.image = vbar::tests::source_path("build/zynq/vbar_zynq7000_overrunning.elf");
    options_.step_budget = kBudget;
    if (!test::has_image(options_)) GTEST_SKIP() << "build/zynq/vbar_zynq7000_overrunning.elf is not built";
    computer_ = make_flight_computer(options_);
  }

  StepReport fly(std::uint32_t step, std::int64_t turns) {
    const Packet tick = tick_at(step, turns);
    return computer_->step(step, std::span(&tick, 1)).report;
  }
  std::string failure(std::uint32_t step, std::int64_t turns) {
    try {
      (void)fly(step, turns);
    } catch (const FlightComputerError& error) {
      return error.what();
    }
    return "no failure";
  }

  FlightComputerOptions options_ = test::echo_options(Target::kZynqQemu, GetParam());
  std::unique_ptr<FlightComputer> computer_;
};

TEST_P(Supervision, AStepWithinItsBudgetPassesAndOneBeyondIsAFailureWithBothNumbers) {
  const StepReport within = fly(0, kShort);
  EXPECT_EQ(within.unit, "instructions");
  EXPECT_GT(within.count, static_cast<std::uint64_t>(kShort));
  EXPECT_LT(within.count, kBudget);
  const std::uint64_t expected = within.count * (kLong / kShort);  // a loop and little else
  const std::string text = failure(1, kLong);
  EXPECT_THAT(
      text, AllOf(HasSubstr("failed at step 1: the step took "), HasSubstr(" instructions, and its budget is 2000000"),
                  HasSubstr("step 1 exceeded its budget")));
  const std::size_t at = text.find("took ") + 5;
  const std::uint64_t counted = std::stoull(text.substr(at));
  EXPECT_GT(counted, kBudget);
  EXPECT_NEAR(static_cast<double>(counted), static_cast<double>(expected), 0.05 * static_cast<double>(expected));
}

TEST_P(Supervision, AStepThatDoesNotEndIsEndedByTheWatchdogAndTheHostIsToldWhy) {
  (void)fly(0, kShort);
  const auto start = std::chrono::steady_clock::now();
  const std::string text = failure(1, kEndless);
  EXPECT_THAT(text,
              AllOf(HasSubstr("failed at step 1: the board has lost its session: its watchdog reset it in step 1"),
                    HasSubstr("the budget of a step is 2000000 instructions"), HasSubstr("WATCHDOG expired"),
                    HasSubstr("reset by the watchdog"), HasSubstr("ready")));
  // By its own answer: not because the host has lost patience.
  EXPECT_LT(std::chrono::steady_clock::now() - start, options_.timing.give_up_after);
}

INSTANTIATE_TEST_SUITE_P(Links, Supervision, testing::Values(LinkKind::kSerial, LinkKind::kUdp),
                         [](const auto& of) { return std::string(name_of(of.param)); });

}  // namespace

}  // namespace vbar::pil
