// The scenario file: what is accepted, and one sentence with file, line and key for all else.

#include "hil_drivers/grand/bench/generator/scenario.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host_sim/mission/mission_error.h"
#include "tests/support/paths.h"
#include "tests/unit/hil_drivers/grand/bench/generator/bench_directory.h"

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

  test::BenchDirectory directory;
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
}  // namespace vbar::grand::bench
