// The program vbar_grand_bench from outside: a client of its Skydel protocol and of its serial lines, in lock-step.

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>
#include <termios.h>
#include <toml++/toml.h>

#include "hil_drivers/grand/generators/generator.h"
#include "host_sim/io/child_process.h"
#include "host_sim/io/file_descriptor.h"
#include "tests/support/gnss_scene.h"
#include "tests/support/grand_orbit.h"
#include "tests/support/paths.h"
#include "tests/unit/emulators/grand/bench_directory.h"

namespace vbar::grand {
namespace {

using namespace std::chrono_literals;
using test::read_available;
using ::testing::HasSubstr;

const fsw::Vector3 kBaseline(5.0, -3.0, 6.0);
constexpr std::array<const char*, 2> kVehicles{"servicer", "target"};

/// A bench process and what its user has of it.
class EmulatorProcess {
 public:
  explicit EmulatorProcess(const std::vector<std::string>& options = {}) {
    std::vector<std::string> arguments{tests::build_path("vbar_grand_bench"),
                                       tests::source_path("data/benches/grand.toml"), "--directory",
                                       directory.path().string()};
    arguments.insert(arguments.end(), options.begin(), options.end());
    process = std::make_unique<io::ChildProcess>(arguments, std::vector<io::FileDescriptor>{});
    const auto file = directory.path() / "addresses.json";
    for (int k = 0; k < 2000 && !std::filesystem::exists(file) && !process->has_ended(); ++k)
      std::this_thread::sleep_for(10ms);
    if (!std::filesystem::exists(file)) throw std::runtime_error("no addresses: " + process->output_tail());
    addresses = nlohmann::json::parse(std::ifstream(file));
    for (const char* name : kVehicles) lines.push_back(open_line(addresses["receivers"][name]["com1"]));
  }

  static io::FileDescriptor open_line(const std::string& path) {
    io::FileDescriptor line(::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK));
    termios settings{};
    ::tcgetattr(line.get(), &settings);
    ::cfmakeraw(&settings);
    ::cfsetspeed(&settings, B115200);
    ::tcsetattr(line.get(), TCSANOW, &settings);
    return line;
  }

  std::unique_ptr<Generator> skydel() const {
    const GeneratorKind* kind = generator_kinds().front();
    GeneratorPlan plan;
    plan.start = test::kGnssStart;
    plan.vehicles = {kVehicles.begin(), kVehicles.end()};
    plan.sample_period = fsw::Duration{100'000'000};
    plan.join = fsw::Duration{165'000'000};
    plan.host = "127.0.0.1";
    plan.control_ports = addresses["control_ports"].get<std::vector<std::uint16_t>>();
    const toml::table none;
    return kind->make(plan, *kind->read(mission::TableReader(none, "none")));
  }

  /// A command and its answer, before the run.
  std::string ask(std::size_t vehicle, const std::string& command) const {
    const std::string line = command + "\r\n";
    if (::write(lines[vehicle].get(), line.data(), line.size()) < 0) return "not written";
    std::string answer;
    for (int k = 0; k < 500 && answer.find("[COM1]") == std::string::npos; ++k) {
      std::this_thread::sleep_for(2ms);
      answer += read_available(lines[vehicle].get());
    }
    return answer;
  }

  test::EmulatorDirectory directory;
  std::unique_ptr<io::ChildProcess> process;
  nlohmann::json addresses;
  std::vector<io::FileDescriptor> lines;
};

TrajectorySample sample(std::size_t vehicle, int tenth) {
  return test::sample_in_orbit(0.1 * tenth, static_cast<double>(vehicle) * kBaseline);
}

struct Flown {
  std::array<std::string, 2> bytes;
  double wall_s = 0.0;
};

Flown fly(EmulatorProcess& bench, int tenths) {
  for (std::size_t vehicle = 0; vehicle < 2; ++vehicle) {
    read_available(bench.lines[vehicle].get());
    EXPECT_THAT(bench.ask(vehicle, "LOG COM1 RANGEB ONTIME 1"), HasSubstr("<OK"));
    EXPECT_THAT(bench.ask(vehicle, "LOG COM1 RAWEPHEMB ONCHANGED"), HasSubstr("<OK"));
    EXPECT_THAT(bench.ask(vehicle, "LOG COM1 BESTXYZB ONTIME 1"), HasSubstr("<OK"));
  }
  const auto generator = bench.skydel();
  const std::array<TrajectorySample, 2> first{sample(0, 0), sample(1, 0)};
  generator->prepare(first);
  generator->start();
  Flown flown;
  const auto begin = std::chrono::steady_clock::now();
  for (int tenth = 1; tenth <= tenths; ++tenth) {
    for (std::size_t vehicle = 0; vehicle < 2; ++vehicle) {
      const TrajectorySample next = sample(vehicle, tenth);
      generator->send(vehicle, next);
      EXPECT_EQ(generator->wait_for(vehicle, next.time, std::chrono::steady_clock::now() + 20s), next.time);
      flown.bytes[vehicle] += read_available(bench.lines[vehicle].get());
    }
    if (::testing::Test::HasFailure()) return flown;
  }
  flown.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  generator->stop();
  return flown;
}

/// Messages by their number, as the headers of binary logs state it.
std::map<int, int> logs_of(const std::string& bytes) {
  std::map<int, int> logs;
  const std::string sync("\xAA\x44\x12", 3);
  for (std::size_t at = bytes.find(sync); at != std::string::npos && at + 28 <= bytes.size();
       at = bytes.find(sync, at + 3))
    ++logs[static_cast<unsigned char>(bytes[at + 4]) + 256 * static_cast<unsigned char>(bytes[at + 5])];
  return logs;
}

// 120 s of both vehicles, twice: the same bytes on both lines, and they hold observations and solutions.
TEST(EmulatorProcess, LockStepGivesTheSameBytes) {
  std::array<Flown, 2> runs;
  for (Flown& run : runs) {
    EmulatorProcess bench;
    run = fly(bench, 1200);
    bench.process->terminate(5s);
    EXPECT_EQ(bench.process->status_text(), "exit status 0") << bench.process->output_tail();
    EXPECT_FALSE(std::filesystem::exists(std::filesystem::symlink_status(bench.directory.path() / "servicer.com1")));
  }
  for (std::size_t vehicle = 0; vehicle < 2; ++vehicle) {
    EXPECT_TRUE(runs[0].bytes[vehicle] == runs[1].bytes[vehicle]) << kVehicles[vehicle];
    const auto logs = logs_of(runs[0].bytes[vehicle]);
    // RANGE begins when the receiver has set its clock: after search and 18 to 36 s of subframes.
    EXPECT_GE(logs.contains(43) ? logs.at(43) : 0, 75) << "RANGE";
    EXPECT_GE(logs.contains(41) ? logs.at(41) : 0, 5) << "RAWEPHEM";
    EXPECT_GE(logs.contains(241) ? logs.at(241) : 0, 100) << "BESTXYZ";
  }
  RecordProperty("speed", fmt::format("{:.0f}", 120.0 / runs[0].wall_s));
}

TEST(EmulatorProcess, AnotherSeedGivesOtherBytes) {
  std::array<Flown, 2> runs;
  for (int seed = 1; seed <= 2; ++seed) {
    EmulatorProcess bench({"--seed", std::to_string(seed)});
    runs[static_cast<std::size_t>(seed) - 1] = fly(bench, 700);
  }
  EXPECT_FALSE(runs[0].bytes[0] == runs[1].bytes[0]);
}

TEST(EmulatorProcess, ScenarioWithAnErrorIsRefusedInOneSentence) {
  const test::EmulatorDirectory directory;
  io::ChildProcess process({tests::build_path("vbar_grand_bench"), tests::source_path("data/benches/grand.toml"),
                            "--directory", directory.path().string(), "--set", "bench.channel_phase_mm=-1"},
                           {});
  ASSERT_TRUE(process.wait_for_end(20s));
  EXPECT_EQ(process.status_text(), "exit status 2");
  EXPECT_THAT(process.output_tail(), HasSubstr("bench.channel_phase_mm: found the integer -1"));
}

TEST(EmulatorProcess, ExitsWhenTheScenarioSaysSo) {
  EmulatorProcess bench;
  const auto generator = bench.skydel();
  const std::array<TrajectorySample, 2> first{sample(0, 0), sample(1, 0)};
  generator->prepare(first);
  generator->start();
  io::ChildProcess client({"/usr/bin/python3", "-c",
                           "import socket,sys; s=socket.socket(socket.AF_UNIX); s.connect(sys.argv[1]); "
                           "s.sendall(b'{\"kind\":\"bench_exit\"}\\n'); s.recv(100)",
                           bench.addresses["faults"].get<std::string>()},
                          {});
  ASSERT_TRUE(bench.process->wait_for_end(20s));
  EXPECT_EQ(bench.process->status_text(), "exit status 3");
}

}  // namespace
}  // namespace vbar::grand
