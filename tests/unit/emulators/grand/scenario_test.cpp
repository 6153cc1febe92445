// The scenario file: what is accepted, and one sentence with file, line and key for all else.

#include "emulators/grand/generator/scenario.h"

#include <fstream>

#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/write.hpp>
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "emulators/grand/generator/emulator.h"
#include "hil_drivers/grand/pps/edge_source.h"
#include "host_sim/mission/mission_error.h"
#include "tests/support/gnss_scene.h"
#include "tests/support/grand_orbit.h"
#include "tests/support/paths.h"
#include "tests/unit/emulators/grand/bench_directory.h"
#include "tests/unit/emulators/grand/fake_receiver.h"

namespace vbar::grand::bench {

namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

const std::string kVehicles = "[[vehicle]]\nname = \"servicer\"\n[[vehicle]]\nname = \"target\"\n";

class ScenarioTest : public ::testing::Test {
 protected:
  Scenario read(const std::string& text, const std::vector<std::string>& assignments = {}) {
    std::ofstream(file) << text;
    return read_scenario(file, assignments);
  }
  std::string error_of(const std::string& text, const std::vector<std::string>& assignments = {}) {
    try {
      read(text, assignments);
    } catch (const mission::MissionError& error) {
      return error.what();
    }
    return "no error";
  }

  test::EmulatorDirectory directory;
  std::filesystem::path file = directory.path() / "s.toml";
};

TEST_F(ScenarioTest, TheFileOfTheProjectHasTheDefaults) {
  const Scenario scenario = read_scenario(tests::source_path("data/benches/grand.toml"), {});
  EXPECT_EQ(scenario.seed, 1U);
  EXPECT_EQ(scenario.pace, Pace::kLockStep);
  EXPECT_EQ(scenario.control.protocol, ControlProtocol::kSkydel);
  EXPECT_EQ(scenario.vehicle_names(), (std::vector<std::string>{"servicer", "target"}));
  EXPECT_EQ(scenario.sky.box, BoxErrorSettings{});
  EXPECT_EQ(scenario.sky.visibility, twins::gnss::VisibilitySettings{});
  EXPECT_EQ(scenario.sky.link_budget, twins::gnss::LinkBudgetSettings{});
  EXPECT_EQ(scenario.constellation, twins::gnss::ConstellationSettings{});
  EXPECT_EQ(scenario.vehicles[1].receiver, ReceiverSettings{});
  EXPECT_TRUE(scenario.faults.empty());
}

// Every commented key of the file is a known key with the default that it states.
TEST_F(ScenarioTest, TheFileOfTheProjectExplainsKeysThatExist) {
  std::ifstream in(tests::source_path("data/benches/grand.toml"));
  std::string text;
  for (std::string line; std::getline(in, line);) {
    const bool is_key =
        line.starts_with("# ") && line.find(" = ") != std::string::npos && line.find("[[") == std::string::npos;
    if (line.starts_with("# Faults")) break;
    text += (is_key ? line.substr(2) : line) + "\n";
  }
  const Scenario scenario = read(text);
  EXPECT_EQ(scenario.sky.box, BoxErrorSettings{});
  EXPECT_EQ(scenario.vehicles[0].receiver, ReceiverSettings{});
  EXPECT_EQ(scenario.constellation, twins::gnss::ConstellationSettings{});
  EXPECT_EQ(scenario.engine_latency.ns, 40'000'000);
  EXPECT_EQ(scenario.join.ns, 165'000'000);
}

TEST_F(ScenarioTest, AssignmentsReplaceValues) {
  const Scenario scenario =
      read(kVehicles, {"seed=7", "pace=real_time", "bench.channel_phase_mm=2", "generator.protocol=simgen"});
  EXPECT_EQ(scenario.seed, 7U);
  EXPECT_EQ(scenario.pace, Pace::kRealTime);
  EXPECT_EQ(scenario.sky.box.channel_phase_mm, 2.0);
  EXPECT_EQ(scenario.control.protocol, ControlProtocol::kSimgen);
  const Scenario shifted = read(kVehicles, {"vehicle.target.receiver.week_shift=1024"});
  EXPECT_EQ(shifted.vehicles[0].receiver.week_shift, 0);
  EXPECT_EQ(shifted.vehicles[1].receiver.week_shift, 1024);
  EXPECT_THAT(error_of(kVehicles, {"vehicle.moon.com_ports=1"}), HasSubstr("vehicle.servicer or target"));
}

TEST_F(ScenarioTest, FaultsAreRead) {
  const Scenario scenario = read(kVehicles +
                                 "[[fault]]\nkind = \"rf_outage\"\ntime_s = 60\nvehicle = \"target\"\nduration_s = 30\n"
                                 "[[fault]]\nkind = \"generator_refuses\"\ncommand = \"ArmPPS\"\n"
                                 "[[fault]]\nkind = \"host_baud\"\nvehicle = \"servicer\"\nport = 2\nbaud = 9600\n");
  ASSERT_EQ(scenario.faults.size(), 3U);
  EXPECT_EQ(scenario.faults[0].kind, FaultKind::kRfOutage);
  EXPECT_EQ(scenario.faults[0].time, fsw::duration_of_seconds(60));
  EXPECT_EQ(scenario.faults[0].duration, fsw::duration_of_seconds(30));
  EXPECT_EQ(scenario.faults[0].vehicle, 1U);
  EXPECT_EQ(scenario.faults[1].time, std::nullopt);
  EXPECT_EQ(scenario.faults[1].text, "ArmPPS");
  EXPECT_EQ(scenario.faults[2].port, 1U);
  EXPECT_EQ(scenario.faults[2].value, 9600.0);
}

TEST_F(ScenarioTest, ErrorsNameFileLineAndKey) {
  EXPECT_THAT(error_of(kVehicles + "[bench]\nchannel_phase_mm = -1\n"),
              AllOf(StartsWith(file.string() + ":6: bench.channel_phase_mm: "), HasSubstr("from 0 to 100")));
  EXPECT_THAT(error_of(kVehicles + "[bench]\nchannel_phase = 1\n"), HasSubstr("channel_phase"));
  EXPECT_THAT(error_of("pace = \"slow\"\n" + kVehicles), HasSubstr("lock_step or real_time"));
  EXPECT_THAT(error_of("seed = 1\n"), HasSubstr("1 to 8 tables [[vehicle]]"));
  EXPECT_THAT(error_of(kVehicles + "[[vehicle]]\nname = \"target\"\n"), HasSubstr("a name that no other vehicle has"));
  EXPECT_THAT(error_of(kVehicles + "[[fault]]\nkind = \"earthquake\"\n"), HasSubstr("line_hang_up"));
  EXPECT_THAT(error_of(kVehicles + "[[fault]]\nkind = \"rf_outage\"\nvehicle = \"moon\"\n"),
              HasSubstr("servicer or target"));
  EXPECT_THAT(error_of(kVehicles + "[[fault]]\nkind = \"rf_outage\"\nvehicle = \"target\"\nport = 1\n"),
              HasSubstr("port"));
  EXPECT_THAT(error_of(kVehicles, {"bench.channel_phase_mm=nan"}), HasSubstr("bench.channel_phase_mm"));
  EXPECT_THAT(error_of(kVehicles + "[bench\n"), HasSubstr("invalid TOML"));
}

TEST(FaultFromJson, LineOfTheControlSocket) {
  const std::vector<std::string> vehicles{"servicer", "target"};
  const Fault fault = fault_from_json(R"({"kind":"cn0_drop","vehicle":"target","db":15,"duration_s":60.5})", vehicles);
  EXPECT_EQ(fault.kind, FaultKind::kCn0Drop);
  EXPECT_EQ(fault.value, 15.0);
  EXPECT_EQ(fault.duration.ns, 60'500'000'000);
  for (const char* bad :
       {"", "{", "[]", "null", R"({"kind":3})", R"({"kind":"cn0_drop"})",
        R"({"kind":"cn0_drop","vehicle":"target","db":1e400})", R"({"kind":"cn0_drop","vehicle":"target","db":[1]})",
        R"({"kind":"cn0_drop","vehicle":"target","db":1,"x":2})"})
    EXPECT_THROW(fault_from_json(bad, vehicles), mission::MissionError) << bad;
}

}  // namespace

// The whole bench in one event loop: addresses, edges on their socket, faults by scenario and by control line.

namespace {

using namespace std::chrono_literals;
using fsw::Duration;
using test::read_available;
using vbar::test::sample_in_orbit;

class BenchTest : public ::testing::Test {
 protected:
  void make(std::vector<Fault> faults = {}) {
    Scenario scenario;
    scenario.vehicles = {{"servicer", 2, {}}, {"target", 1, {}}};
    scenario.faults = std::move(faults);
    bench =
        std::make_unique<Bench>(context, scenario, test::data_directory(), directory.path(), test::fake_receivers());
    host = io::FileDescriptor(::open((directory.path() / "servicer.com1").c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK));
  }
  void start() {
    GeneratorEngine& engine = bench->engine();
    ASSERT_EQ(engine.set_start_time(test::kGnssStart), "");
    for (std::size_t k = 0; k < 2; ++k) engine.sample(k, sample_in_orbit(0.0));
    ASSERT_EQ(engine.arm(), "");
    ASSERT_EQ(engine.start(Duration{}), "");
  }
  /// Both vehicles, block by block, up to `time_s`; bytes of the servicer's first port.
  std::string fly(double time_s) {
    std::string bytes;
    for (; 0.1 * next < time_s + 1e-9; ++next) {
      for (std::size_t k = 0; k < 2; ++k) bench->engine().sample(k, sample_in_orbit(0.1 * next));
      bytes += read_available(host.get());
    }
    return bytes;
  }
  std::vector<nlohmann::json> acknowledged() const {
    std::vector<nlohmann::json> lines;
    std::ifstream in(directory.path() / "faults.jsonl");
    for (std::string line; std::getline(in, line);) lines.push_back(nlohmann::json::parse(line));
    return lines;
  }
  static Fault fault(FaultKind kind, double time_s, double duration_s = 0.0, double value = 0.0) {
    Fault fault;
    fault.kind = kind;
    fault.time = fsw::nearest_duration(time_s);
    fault.duration = fsw::nearest_duration(duration_s);
    fault.value = value;
    return fault;
  }

  test::EmulatorDirectory directory;
  boost::asio::io_context context;
  std::unique_ptr<Bench> bench;
  io::FileDescriptor host;
  int next = 1;
};

TEST_F(BenchTest, AddressesNameEverythingThatListens) {
  make();
  const auto addresses = nlohmann::json::parse(std::ifstream(directory.path() / "addresses.json"));
  EXPECT_EQ(addresses["control_ports"].size(), 2U);
  for (const auto& port : addresses["control_ports"]) EXPECT_GT(port.get<int>(), 0);
  EXPECT_EQ(addresses["pps"], (directory.path() / "pps.sock").string());
  EXPECT_EQ(addresses["receivers"]["servicer"]["com2"], (directory.path() / "servicer.com2").string());
  EXPECT_FALSE(addresses["receivers"]["target"].contains("com2"));
  for (const char* name : {"pps.sock", "faults.sock", "servicer.com1"})
    EXPECT_TRUE(std::filesystem::exists(directory.path() / name)) << name;
  bench.reset();
  for (const char* name : {"pps.sock", "faults.sock", "servicer.com1", "addresses.json"})
    EXPECT_FALSE(std::filesystem::exists(std::filesystem::symlink_status(directory.path() / name))) << name;
}

TEST_F(BenchTest, LinesHangUpAndComeBack) {
  make({fault(FaultKind::kLineHangUp, 1.0, 2.0)});
  start();
  EXPECT_FALSE(fly(0.9).empty());
  fly(1.1);
  EXPECT_FALSE(std::filesystem::exists(std::filesystem::symlink_status(directory.path() / "servicer.com1")));
  ASSERT_EQ(acknowledged().size(), 1U);
  EXPECT_EQ(acknowledged()[0]["kind"], "line_hang_up");
  EXPECT_NEAR(acknowledged()[0]["time_s"].get<double>(), 1.0, 1e-9);
  EXPECT_EQ(fly(2.9), "");
  fly(3.1);
  host = io::FileDescriptor(::open((directory.path() / "servicer.com1").c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK));
  EXPECT_FALSE(fly(3.5).empty());
}

TEST_F(BenchTest, OutageHasAnEffectBeforeItIsAcknowledged) {
  make({fault(FaultKind::kRfOutage, 1.0, 1.0)});
  start();
  fly(1.0);
  EXPECT_TRUE(acknowledged().empty());  // injected, but no block without signals has been flown
  fly(1.1);
  ASSERT_EQ(acknowledged().size(), 1U);
  EXPECT_TRUE(bench->engine().vehicle(0).last_block().signals.empty());
  EXPECT_FALSE(bench->engine().vehicle(1).last_block().signals.empty());
  fly(2.2);
  EXPECT_FALSE(bench->engine().vehicle(0).last_block().signals.empty());
}

TEST_F(BenchTest, BytesOfALineAreDamaged) {
  make({fault(FaultKind::kLineGarbage, 1.0, 1.0), fault(FaultKind::kLineHalfMessages, 3.0, 1.0),
        fault(FaultKind::kLineFlood, 5.0, 0.5)});
  start();
  const std::size_t clean = fly(1.0).size();
  EXPECT_GT(fly(2.0).size(), clean + 300);  // 40 bytes every 100 ms
  const std::size_t undamaged = fly(3.0).size();
  EXPECT_NEAR(static_cast<double>(undamaged), static_cast<double>(clean), 80.0);
  const std::size_t half = fly(4.0).size();
  EXPECT_LT(half, 0.75 * static_cast<double>(clean));
  fly(5.0);
  EXPECT_GT(fly(5.5).size(), 50'000U);
  EXPECT_EQ(acknowledged().size(), 3U);
}

TEST_F(BenchTest, CommandsOfTheHostAreLostOrSpoiled) {
  Fault silent = fault(FaultKind::kReceiverUnanswered, 0.0);
  silent.time.reset();
  make({silent});
  ASSERT_EQ(::write(host.get(), "version\n", 8), 8);
  context.run_for(50ms);
  EXPECT_EQ(read_available(host.get()), "");
  bench->faults().advance();
  EXPECT_EQ(acknowledged().size(), 1U);
  bench.reset();
  Fault refuses = fault(FaultKind::kReceiverRefuses, 0.0);
  refuses.time.reset();
  make({refuses});
  ASSERT_EQ(::write(host.get(), "version\n", 8), 8);
  context.restart();
  context.run_for(50ms);
  EXPECT_THAT(read_available(host.get()), ::testing::Not(HasSubstr("version")));
}

TEST_F(BenchTest, BaudRatesChangeAtEitherEnd) {
  make({fault(FaultKind::kReceiverBaud, 0.5, 0.0, 57600.0), fault(FaultKind::kHostBaud, 1.0, 0.0, 9600.0)});
  start();
  fly(0.4);
  EXPECT_EQ(bench->engine().vehicle(0).receiver().baud(0), 115200U);
  fly(1.2);
  EXPECT_EQ(bench->engine().vehicle(0).receiver().baud(0), 57600U);
  EXPECT_EQ(bench->engine().vehicle(0).ports()[0].line->host_baud(), 9600U);
  EXPECT_EQ(acknowledged().size(), 2U);
}

TEST_F(BenchTest, EdgesAreMissingAndDoubled) {
  make({fault(FaultKind::kPpsMissing, 1.5, 0.0, 1.0), fault(FaultKind::kPpsDoubled, 3.5, 0.0, 1.0)});
  const auto edges = kSocketEdges.make((directory.path() / "pps.sock").string());
  EXPECT_FALSE(edges->next(io::Clock::now()));  // subscribes
  start();
  fly(5.0);
  std::vector<std::uint32_t> counts;
  while (const auto edge = edges->next(io::Clock::now() + 100ms)) counts.push_back(edge->count);
  EXPECT_EQ(counts, (std::vector<std::uint32_t>{0, 1, 3, 4, 4, 5}));
  EXPECT_EQ(acknowledged().size(), 2U);
}

TEST_F(BenchTest, GeneratorDiesAndComesBack) {
  make({fault(FaultKind::kGeneratorDies, 1.0, 0.2)});
  start();
  fly(1.0);
  EXPECT_EQ(bench->engine().state(), EngineState::kStopped);
  EXPECT_EQ(acknowledged().size(), 1U);
  context.run_for(400ms);
  bench->faults().advance();
  EXPECT_EQ(bench->engine().state(), EngineState::kIdle);
}

TEST_F(BenchTest, GeneratorReportsAnError) {
  Fault error = fault(FaultKind::kGeneratorError, 1.0);
  error.text = "The signal processor has stopped.";
  make({error});
  start();
  fly(1.0);
  EXPECT_EQ(bench->engine().state(), EngineState::kError);
  EXPECT_EQ(bench->engine().error(), "The signal processor has stopped.");
}

TEST_F(BenchTest, ControlLineInjectsAndAcknowledges) {
  make();
  start();
  boost::asio::local::stream_protocol::socket client(context);
  client.connect((directory.path() / "faults.sock").string());
  client.non_blocking(true);
  const auto say = [&](const std::string& line) {
    boost::asio::write(client, boost::asio::buffer(line + "\n"));
    context.restart();
    context.run_for(50ms);
    return read_available(client.native_handle());
  };
  EXPECT_THAT(say("nonsense"), HasSubstr("\"error\""));
  EXPECT_THAT(say(R"({"kind":"rf_outage","vehicle":"moon"})"), HasSubstr("servicer or target"));
  EXPECT_EQ(say(R"({"kind":"cn0_drop","vehicle":"servicer","db":15,"duration_s":60})"), "");  // no effect yet
  fly(0.1);
  const auto answer = nlohmann::json::parse(read_available(client.native_handle()));
  EXPECT_EQ(answer["injected"]["kind"], "cn0_drop");
  EXPECT_EQ(answer["injected"]["db"], 15.0);
  EXPECT_EQ(acknowledged().size(), 1U);
}

}  // namespace

}  // namespace vbar::grand::bench
