// The emulated Skydel refuses what a real instance refuses: commands out of order, with missing or wrong fields,
// unknown ones.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil_drivers/grand/bench/control/skydel_commands.h"
#include "tests/unit/hil_drivers/grand/generators/loopback.h"

namespace vbar::grand::test {
namespace {

using testing::HasSubstr;
using wire::Json;

class SkydelOrder : public testing::Test {
 protected:
  /// "" for a success, the message of an ErrorResult.
  std::string send(std::size_t instance, const std::string& name, const Json& fields = Json::object()) {
    const auto result = commands_.execute(instance, wire::skydel_command(name, "{1}", fields),
                                          [this](const Json& later) { later_ = later; });
    if (!result) return "later";
    EXPECT_EQ(result->at("CmdUuid"), "{1}");
    EXPECT_EQ(Json::parse(result->at("RelatedCommand").get<std::string>()).at("CmdName"), name);
    return result->at("CmdName") == "ErrorResult" ? result->at("ErrorMsg").get<std::string>() : "";
  }
  void configure(std::size_t instance, const Json& start = wire::skydel_date(kStart)) {
    EXPECT_EQ(send(instance, "New", {{"DiscardCurrentConfig", true}, {"LoadDefaultConfig", false}}), "");
    EXPECT_EQ(send(instance, "SetModulationTarget",
                   {{"Type", "NoneRT"}, {"Path", ""}, {"Address", ""}, {"ClockIsExternal", true}, {"Id", "x"}}),
              "");
    EXPECT_EQ(send(instance, "ChangeModulationTargetSignals",
                   {{"Output", 0},
                    {"MinRate", 12500000},
                    {"MaxRate", 100000000},
                    {"Band", "UpperL"},
                    {"Signal", "L1CA"},
                    {"Gain", -1},
                    {"GPU", false},
                    {"Id", "x"}}),
              "");
    EXPECT_EQ(send(instance, "SetGpsStartTime", {{"Start", start}}), "");
    EXPECT_EQ(send(instance, "SetVehicleTrajectory", {{"Type", "HIL"}}), "");
    EXPECT_EQ(send(instance, "SetHilTjoin", {{"HilTjoin", 165}}), "");
    EXPECT_EQ(
        send(instance, instance == 0 ? "EnableMainInstanceSync" : "EnableWorkerInstanceSync", {{"Enabled", true}}), "");
  }
  void fire_edge() {
    for (const auto& call : std::exchange(engine_.on_next_edge, {})) call();
  }

  FakeEngine engine_{2};
  bench::SkydelCommands commands_{engine_, {}, {40001, 40002}};
  Json later_;
};

TEST_F(SkydelOrder, AnUnknownCommandIsRefused) {
  EXPECT_EQ(send(0, "SelfDestruct"), "The command SelfDestruct is unknown to the emulated Skydel");
}

TEST_F(SkydelOrder, ConfigurationBeginsWithNew) {
  EXPECT_THAT(send(0, "SetVehicleTrajectory", {{"Type", "HIL"}}), HasSubstr("send New first"));
  EXPECT_THAT(send(0, "ArmPPS"), HasSubstr("send New first"));
}

TEST_F(SkydelOrder, FieldsAreChecked) {
  EXPECT_THAT(send(0, "New"), HasSubstr("New: field DiscardCurrentConfig is missing"));
  EXPECT_THAT(send(0, "New", {{"DiscardCurrentConfig", 1}, {"LoadDefaultConfig", false}}),
              HasSubstr("New: field DiscardCurrentConfig is 1; true or false is expected"));
  configure(0);
  EXPECT_THAT(send(0, "SetVehicleTrajectory", {{"Type", "Circular"}}), HasSubstr("no trajectory \"Circular\""));
  EXPECT_THAT(send(0, "SetHilTjoin", {{"HilTjoin", 1e9}}), HasSubstr("field HilTjoin"));
  EXPECT_THAT(send(0, "SetHilTjoin", {{"HilTjoin", 10}}), HasSubstr("below the engine latency of 40 ms"));
  EXPECT_THAT(send(0, "SetGpsStartTime", {{"Start", "today"}}), HasSubstr("a date is expected"));
  Json date = wire::skydel_date(kStart);
  date["Month"] = 2;
  date["Day"] = 30;
  EXPECT_THAT(send(0, "SetGpsStartTime", {{"Start", date}}), HasSubstr("2011-02-30"));
}

TEST_F(SkydelOrder, ArmingNeedsEveryInstanceConfiguredAlike) {
  configure(0);
  EXPECT_EQ(send(0, "ArmPPS"), "Instance 1 has no configuration (New)");
  configure(1, wire::skydel_date(kStart + fsw::duration_of_seconds(1)));
  EXPECT_EQ(send(0, "ArmPPS"), "Instance 1 has another start time than the main instance");
  configure(1);
  EXPECT_THAT(send(1, "ArmPPS"), HasSubstr("not the main instance"));
  EXPECT_FALSE(commands_.expects_samples(0));
  EXPECT_EQ(send(0, "ArmPPS"), "");
  EXPECT_TRUE(commands_.expects_samples(0));
  EXPECT_THAT(send(0, "New", {{"DiscardCurrentConfig", true}, {"LoadDefaultConfig", false}}),
              HasSubstr("send Stop first"));
}

TEST_F(SkydelOrder, OnlyTheFirstInstanceIsTheMainInstance) {
  configure(0);
  configure(1);
  EXPECT_THAT(send(1, "EnableMainInstanceSync", {{"Enabled", true}}), HasSubstr("Only the first instance"));
  EXPECT_THAT(send(0, "EnableWorkerInstanceSync", {{"Enabled", true}}), HasSubstr("is the main instance"));
}

TEST_F(SkydelOrder, StartingNeedsArmingAndAnEdge) {
  configure(0);
  configure(1);
  EXPECT_THAT(send(0, "StartPPS", {{"Msec", 0}}), HasSubstr("send ArmPPS first"));
  EXPECT_THAT(send(0, "BeginVehicleInfo"), HasSubstr("send ArmPPS first"));
  EXPECT_EQ(send(0, "ArmPPS"), "");
  EXPECT_THAT(send(0, "StartPPS", {{"Msec", 0}}), HasSubstr("send WaitAndResetPPS first"));
  EXPECT_THAT(send(0, "GetComputerSystemTimeSinceEpochAtPps0"), HasSubstr("send StartPPS first"));
  EXPECT_EQ(send(0, "WaitAndResetPPS"), "later");
  EXPECT_THAT(send(0, "StartPPS", {{"Msec", 0}}), HasSubstr("send WaitAndResetPPS first"));
  EXPECT_TRUE(later_.is_null());
  fire_edge();
  EXPECT_EQ(later_.at("CmdName"), "SuccessResult");
  EXPECT_EQ(send(0, "StartPPS", {{"Msec", 2000}}), "");
  EXPECT_EQ(engine_.delay, fsw::duration_of_seconds(2));
  EXPECT_THAT(send(0, "StartPPS", {{"Msec", 0}}), HasSubstr("already"));
  EXPECT_THAT(send(0, "SetHilTjoin", {{"HilTjoin", 165}}), HasSubstr("needs an idle simulator"));
}

TEST_F(SkydelOrder, AStopBeforeTheEdgeAnswersTheWaitWithAnError) {
  configure(0);
  configure(1);
  EXPECT_EQ(send(0, "ArmPPS"), "");
  EXPECT_EQ(send(0, "WaitAndResetPPS"), "later");
  EXPECT_EQ(send(0, "Stop"), "");
  fire_edge();
  EXPECT_EQ(later_.at("CmdName"), "ErrorResult");
}

// Values of the API: StateIdle 1, StateStarted 2; Started_Streaming 5, Started_Armed 8.
TEST_F(SkydelOrder, StatesAreThoseOfTheApi) {
  const auto state = [&] {
    const auto result = *commands_.execute(0, wire::skydel_command("GetSimulatorState", "{1}"), {});
    return std::pair(result.at("State").get<std::string>(), result.at("SubStateId").get<int>());
  };
  EXPECT_EQ(state(), std::pair(std::string("Idle"), 1));
  engine_.stage = bench::EngineState::kArmed;
  EXPECT_EQ(state(), std::pair(std::string("Armed"), 8));
  engine_.stage = bench::EngineState::kStreaming;
  EXPECT_EQ(state(), std::pair(std::string("Streaming RF"), 5));
}

}  // namespace
}  // namespace vbar::grand::test
