// The Skydel driver and the emulated Skydel: the whole conversation, lost samples, refusals, silence, a closed
// connection.

#include <cmath>
#include <optional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "emulators/grand/control/skydel_commands.h"
#include "host_sim/io/udp_socket.h"
#include "tests/unit/hil_drivers/grand/generators/loopback.h"

namespace vbar::grand::test {

namespace {

using testing::AllOf;
using testing::HasSubstr;

bench::ControlSettings skydel() {
  return {};
}

/// Time for an answer: short enough for a test of silence, long enough for a loaded machine.
const std::string kImpatient = "answer_limit_ms = 1500\n";

TEST(SkydelLoopback, FliesBothVehiclesInLockStep) {
  Loopback loopback(skydel());
  const auto generator = loopback.generator("skydel");
  prepare(*generator);
  EXPECT_EQ(generator->start(), std::nullopt);
  for (int n = 1; n <= 20; ++n) {
    // One vehicle after the other: each runs as far as its own samples.
    for (const std::size_t vehicle : {0U, 1U}) {
      generator->send(vehicle, sample_at(tenths(n), static_cast<double>(vehicle)));
      EXPECT_EQ(generator->wait_for(vehicle, tenths(n), soon()), tenths(n));
    }
  }
  EXPECT_TRUE(generator->is_emulated());
  const GeneratorState state = generator->state(1);
  EXPECT_EQ(state.text, "Streaming RF");
  EXPECT_TRUE(state.is_streaming);
  EXPECT_EQ(state.extrapolation, Extrapolation::kDeterministic);
  generator->stop();
  loopback.in_server([](FakeEngine& engine, bench::ControlServers&) {
    EXPECT_EQ(engine.calls, "reset arm start stop ");
    EXPECT_EQ(engine.start_time, kStart);
    EXPECT_EQ(engine.join, fsw::Duration{165'000'000});
    EXPECT_EQ(engine.delay, fsw::duration_of_seconds(2));
    for (const std::size_t vehicle : {0U, 1U}) {
      ASSERT_EQ(engine.samples[vehicle].size(), 21U);
      for (int n = 0; n <= 20; ++n)
        EXPECT_TRUE(is_same(engine.samples[vehicle][n], sample_at(tenths(n), static_cast<double>(vehicle))));
    }
  });
  EXPECT_EQ(loopback.statistics().refused, 0U);
}

TEST(SkydelLoopback, FliesOneVehicle) {
  Loopback loopback(skydel(), 1);
  const auto generator = loopback.generator("skydel");
  prepare(*generator, 1);
  generator->start();
  generator->send(0, sample_at(kTenth));
  EXPECT_EQ(generator->wait_for(0, kTenth, soon()), kTenth);
}

// UDP may lose a sample: it is sent again after 0.2 s.
TEST(SkydelLoopback, ALostSampleIsSentAgain) {
  Loopback loopback(skydel());
  const auto generator = loopback.generator("skydel");
  prepare(*generator);
  generator->start();
  loopback.in_server([](FakeEngine& engine, bench::ControlServers&) { engine.ignored_samples = 2; });
  generator->send(0, sample_at(kTenth));
  EXPECT_EQ(generator->wait_for(0, kTenth, soon(5.0)), kTenth);
}

// The vehicle information may be lost as well: a sample that comes again is answered.
TEST(SkydelLoopback, AnAnswerToARepeatedSampleReplacesLostVehicleInformation) {
  Loopback loopback(skydel());
  const auto generator = loopback.generator("skydel");
  prepare(*generator);
  generator->start();
  loopback.set_faults({.is_silent = true});
  generator->send(0, sample_at(kTenth));
  EXPECT_EQ(generator->wait_for(0, kTenth, soon(0.1)), fsw::Duration{});
  loopback.set_faults({});
  EXPECT_EQ(generator->wait_for(0, kTenth, soon(5.0)), kTenth);
  loopback.in_server([](FakeEngine& engine, bench::ControlServers&) { EXPECT_EQ(engine.reports[0].time, kTenth); });
}

// In real time a motion does not end on a whole millisecond, but the time tag on the wire does: the position is that of
// the tag. 7.5 km/s in the fraction of a millisecond would be metres.
TEST(SkydelLoopback, VehicleInformationIsOfItsTimeTag) {
  Loopback loopback(skydel());
  const auto generator = loopback.generator("skydel");
  prepare(*generator);
  generator->start();
  io::UdpSocket client("127.0.0.1", loopback.hil_ports()[0], 0, wire::kSkydelMaxHilBytes);
  client.send(wire::encode_hello());
  TrajectorySample sample = sample_at({});
  sample.velocity_ecef_mps = {0.0, 7500.0, 0.0};
  std::optional<wire::SkydelVehicleInfo> info;
  for (int attempt = 0; attempt < 50 && !info; ++attempt) {
    loopback.in_server([&](FakeEngine& engine, bench::ControlServers&) {
      engine.samples[0] = {sample};
      engine.reports[0].time = {1'234'567'890};
      for (const auto& call : engine.on_progress) call(0);
    });
    // Until the greeting has arrived the information goes to the driver.
    if (const auto datagram = client.receive(soon(0.1)))
      info = std::get<wire::SkydelVehicleInfo>(wire::decode_hil(*datagram));
  }
  ASSERT_TRUE(info.has_value());
  EXPECT_EQ(info->time_ms, 1234U);
  EXPECT_NEAR(info->position_ecef_m.y(), sample.position_ecef_m.y() + 7500.0 * 1.234, 7500.0 * 1e-6);
}

TEST(SkydelLoopback, InRealTimeTheStartIsThatOfTheGeneratorsClock) {
  Loopback loopback(skydel());
  using namespace std::chrono;
  const auto now_ms = duration_cast<milliseconds>(system_clock::now().time_since_epoch()).count();
  loopback.in_server([&](FakeEngine& engine, bench::ControlServers&) { engine.pps0_ms = now_ms; });
  const auto reference = steady_clock::now();
  const auto generator = loopback.generator("skydel", "start_after_pps_ms = 1500", Pace::kRealTime);
  prepare(*generator);
  const auto start = generator->start();
  ASSERT_TRUE(start.has_value());
  // PPS0 was taken just before `reference`; on a loaded machine the thread may be interrupted between two readings of
  // the clocks.
  EXPECT_NEAR(duration<double>(*start - reference).count(), 1.5, 0.3);
}

TEST(SkydelLoopback, WithoutATimeOfTheEdgeTheEdgesMustTell) {
  Loopback loopback(skydel());
  const auto generator = loopback.generator("skydel", "", Pace::kRealTime);
  prepare(*generator);
  EXPECT_EQ(generator->start(), std::nullopt);
}

TEST(SkydelLoopback, ARefusedCommandIsOneSentence) {
  for (const char* command : {"New", "SetHilTjoin", "ArmPPS"}) {
    Loopback loopback(skydel());
    loopback.set_faults({.refused_command = command, .refusal = "No license"});
    const auto generator = loopback.generator("skydel");
    EXPECT_EQ(error_of([&] { prepare(*generator); }),
              "Skydel at 127.0.0.1:" + std::to_string(loopback.control_ports()[0]) + ": " + command +
                  ": answered FailureResult: No license");
  }
}

TEST(SkydelLoopback, ARefusalOfTheEngineReachesTheDriver) {
  Loopback loopback(skydel());
  loopback.in_server(
      [](FakeEngine& engine, bench::ControlServers&) { engine.refusal = "No ephemerides for that day"; });
  const auto generator = loopback.generator("skydel");
  EXPECT_THAT(error_of([&] { prepare(*generator); }),
              HasSubstr("SetGpsStartTime: answered FailureResult: No ephemerides for that day"));
}

TEST(SkydelLoopback, AMissingAnswerEndsTheWait) {
  Loopback loopback(skydel());
  loopback.set_faults({.unanswered_command = "GetEngineLatency"});
  const auto generator = loopback.generator("skydel", kImpatient);
  EXPECT_THAT(error_of([&] { prepare(*generator); }), HasSubstr("GetEngineLatency: no answer within 1.5 s"));
}

TEST(SkydelLoopback, AGeneratorThatDoesNotExistIsOneSentence) {
  Loopback other(skydel());
  const auto generator = [&] {
    Loopback loopback(skydel());
    return loopback.generator("skydel", kImpatient);
  }();
  EXPECT_THAT(error_of([&] { prepare(*generator); }), AllOf(HasSubstr("Skydel at 127.0.0.1"), HasSubstr("connecting")));
}

TEST(SkydelLoopback, AClosedConnectionIsNoticedInEveryState) {
  Loopback loopback(skydel());
  loopback.set_faults({.closing_command = "SetVehicleTrajectory"});
  auto generator = loopback.generator("skydel", kImpatient);
  EXPECT_THAT(error_of([&] { prepare(*generator); }),
              HasSubstr("SetVehicleTrajectory: the generator closed the connection"));

  loopback.set_faults({.refuses_connections = true});
  generator = loopback.generator("skydel", kImpatient);
  EXPECT_THAT(error_of([&] { prepare(*generator); }), HasSubstr("API version: the generator closed the connection"));

  loopback.set_faults({});
  generator = loopback.generator("skydel", kImpatient);
  prepare(*generator);
  generator->start();
  loopback.in_server([](FakeEngine&, bench::ControlServers& servers) {
    servers.set_faults({.is_silent = true});
    servers.close_connections();
  });
  generator->send(0, sample_at(kTenth));
  EXPECT_THAT(error_of([&] { generator->wait_for(0, kTenth, soon(5.0)); }),
              HasSubstr("the generator closed the connection"));
  generator->stop();  // does not throw
}

TEST(SkydelLoopback, ReportsExtrapolationAndErrors) {
  Loopback loopback(skydel());
  const auto generator = loopback.generator("skydel");
  prepare(*generator);
  generator->start();
  // The worst state since the last question is kept until it is asked for.
  loopback.in_server([](FakeEngine& engine, bench::ControlServers&) {
    engine.reports[0].snaps = 1;
    for (const auto& call : engine.on_progress) call(0);
  });
  EXPECT_EQ(generator->state(0).extrapolation, Extrapolation::kSnap);
  EXPECT_EQ(generator->state(0).extrapolation, Extrapolation::kDeterministic);
  EXPECT_EQ(generator->state(1).extrapolation, Extrapolation::kDeterministic);
  loopback.in_server([](FakeEngine& engine, bench::ControlServers&) {
    engine.stage = bench::EngineState::kError;
    engine.error_text = "The radio has stopped";
  });
  const GeneratorState state = generator->state(0);
  EXPECT_FALSE(state.is_streaming);
  EXPECT_EQ(state.error, "The radio has stopped");
}

TEST(SkydelLoopback, AGeneratorThatFailsOrRestartsEndsTheWait) {
  Loopback loopback(skydel());
  auto generator = loopback.generator("skydel");
  prepare(*generator);
  generator->start();
  const auto stop_engine = [&](bench::EngineState state, const std::string& text) {
    loopback.in_server([&](FakeEngine& engine, bench::ControlServers&) {
      engine.stage = state;
      engine.error_text = text;
    });
  };
  stop_engine(bench::EngineState::kError, "The radio has stopped");
  generator->send(0, sample_at(kTenth));
  EXPECT_THAT(error_of([&] { generator->wait_for(0, kTenth, soon(5.0)); }),
              HasSubstr("the generator reports \"The radio has stopped\""));
  stop_engine(bench::EngineState::kIdle, "");
  EXPECT_THAT(error_of([&] { generator->wait_for(0, kTenth, soon(5.0)); }),
              HasSubstr("the generator is \"Ready\", not streaming"));
  // It can be configured again.
  generator = loopback.generator("skydel");
  EXPECT_EQ(error_of([&] { prepare(*generator); }), "");
}

// "Tjoin > engine latency + period + network" (GRAND.md, section 1).
TEST(SkydelLoopback, AJoinTimeBelowLatencyAndPeriodIsRefused) {
  bench::ControlSettings settings = skydel();
  settings.engine_latency_ms = 100;
  Loopback loopback(settings);
  const auto generator = loopback.generator("skydel");
  EXPECT_THAT(error_of([&] { prepare(*generator); }), HasSubstr("answered 100 ms: join_ms = 165 is below"));
}

// A second run on the same instances.
TEST(SkydelLoopback, FliesAgainAfterAStop) {
  Loopback loopback(skydel());
  for (int run = 0; run < 2; ++run) {
    const auto generator = loopback.generator("skydel");
    prepare(*generator);
    generator->start();
    loopback.in_server([](FakeEngine& engine, bench::ControlServers&) { engine.reports[0].time = {}; });
    generator->send(0, sample_at(kTenth));
    EXPECT_EQ(generator->wait_for(0, kTenth, soon()), kTenth);
  }
}

}  // namespace

// The emulated Skydel refuses what a real instance refuses: commands out of order, with missing or wrong fields,
// unknown ones.

namespace {

using wire::Json;

class SkydelOrder : public testing::Test {
 protected:
  /// "" for a success, the message of a FailureResult.
  std::string send(std::size_t instance, const std::string& name, const Json& fields = Json::object()) {
    const auto result = commands_.execute(instance, wire::skydel_command(name, "{1}", fields),
                                          [this](const Json& later) { later_ = later; });
    if (!result) return "later";
    EXPECT_NE(result->at("CmdUuid"), "{1}");
    const Json related = Json::parse(result->at("RelatedCommand").get<std::string>());
    EXPECT_EQ(related.at("CmdName"), name);
    EXPECT_EQ(related.at("CmdUuid"), "{1}");
    return result->at("CmdName") == "FailureResult" ? result->at("ErrorMsg").get<std::string>() : "";
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
                    {"GaussianNoise", false},
                    {"Id", "x"},
                    {"CentralFrequency", nullptr}}),
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
  EXPECT_EQ(send(0, "BeginVehicleInfo"), "");  // permitted in every state
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
  EXPECT_THAT(send(0, "SetHilTjoin", {{"HilTjoin", 165}}), HasSubstr("not permitted while the simulation is armed"));
}

TEST_F(SkydelOrder, AStopBeforeTheEdgeAnswersTheWaitWithAnError) {
  configure(0);
  configure(1);
  EXPECT_EQ(send(0, "ArmPPS"), "");
  EXPECT_EQ(send(0, "WaitAndResetPPS"), "later");
  EXPECT_EQ(send(0, "Stop"), "");
  fire_edge();
  EXPECT_EQ(later_.at("CmdName"), "FailureResult");
}

// A field that only older notes have, and values outside the lists of the API's documentation.
TEST_F(SkydelOrder, SignalsAreThoseOfTheApi) {
  configure(0);
  const Json published = {{"Output", 0},         {"MinRate", 12500000}, {"MaxRate", 12500000},    {"Band", "UpperL"},
                          {"Signal", "L1CA,E1"}, {"Gain", -1},          {"GaussianNoise", false}, {"Id", "x"}};
  EXPECT_EQ(send(0, "ChangeModulationTargetSignals", published), "");
  const auto with = [&](const char* field, const Json& value) {
    Json fields = published;
    fields[field] = value;
    return send(0, "ChangeModulationTargetSignals", fields);
  };
  EXPECT_EQ(with("CentralFrequency", 1575420000.0), "");
  EXPECT_THAT(with("CentralFrequency", "L1"), HasSubstr("field CentralFrequency"));
  EXPECT_THAT(with("MinRate", 12500001), HasSubstr("MinRate 12500001 is not one of 12500000, 25000000"));
  EXPECT_THAT(with("Band", "L1"), HasSubstr("Band L1 is not one of LowerL, UpperL, S-Band, C-Band"));
  EXPECT_THAT(with("Signal", "L1CA,L3"), HasSubstr("Signal L3 is not one of L1CA"));
  Json old = published;
  old.erase("GaussianNoise");
  old["GPU"] = false;
  EXPECT_THAT(send(0, "ChangeModulationTargetSignals", old), HasSubstr("field GaussianNoise is missing"));
}

// The calls of the published example of hardware in the loop, in its order: one instance, without a start time.
TEST_F(SkydelOrder, ThePublishedExampleIsServed) {
  EXPECT_EQ(send(0, "GetEngineLatency"), "");
  EXPECT_EQ(send(0, "GetStreamingBuffer"), "");
  EXPECT_EQ(send(0, "New", {{"DiscardCurrentConfig", true}, {"LoadDefaultConfig", nullptr}}), "");
  EXPECT_EQ(send(0, "SetModulationTarget",
                 {{"Type", "NoneRT"}, {"Path", ""}, {"Address", ""}, {"ClockIsExternal", true}, {"Id", "uniqueId"}}),
            "");
  EXPECT_EQ(send(0, "ChangeModulationTargetSignals",
                 {{"Output", 0},
                  {"MinRate", 12500000},
                  {"MaxRate", 100000000},
                  {"Band", "UpperL"},
                  {"Signal", "L1CA"},
                  {"Gain", -1},
                  {"GaussianNoise", false},
                  {"Id", "uniqueId"},
                  {"CentralFrequency", nullptr}}),
            "");
  EXPECT_EQ(send(0, "EnableLogRaw", {{"Enabled", false}}), "");
  EXPECT_EQ(send(0, "EnableLogHILInput", {{"Enabled", true}}), "");
  EXPECT_EQ(send(0, "SetVehicleTrajectory", {{"Type", "HIL"}}), "");
  EXPECT_EQ(send(0, "EnableMainInstanceSync", {{"Enabled", true}}), "");
  EXPECT_THAT(send(0, "ArmPPS"), HasSubstr("no join time (SetHilTjoin)"));
  EXPECT_EQ(send(0, "SetHilTjoin", {{"HilTjoin", 65}}), "");
  EXPECT_EQ(send(0, "ArmPPS"), "");
  EXPECT_EQ(send(0, "WaitAndResetPPS"), "later");
  fire_edge();
  EXPECT_EQ(send(0, "StartPPS", {{"Msec", 2000}}), "");
  EXPECT_EQ(send(0, "GetComputerSystemTimeSinceEpochAtPps0"), "");
  EXPECT_EQ(send(0, "GetHilExtrapolationState"), "");
  EXPECT_EQ(send(0, "Stop"), "");
  EXPECT_THAT(send(0, "ArmPPS"), HasSubstr("SetHilTjoin"));  // "must be set before every simulation"
}

// Values of the API: StateNone 0, StateIdle 1, StateStarted 2; SubStateNone 0, Idle_ConfigNotValid 1, Idle_ConfigValid
// 2, Started_Streaming 5, Started_Armed 8.
TEST_F(SkydelOrder, StatesAreThoseOfTheApi) {
  const auto state = [&] {
    const auto result = *commands_.execute(0, wire::skydel_command("GetSimulatorState", "{1}"), {});
    return std::pair(result.at("State").get<std::string>(), result.at("SubStateId").get<int>());
  };
  EXPECT_EQ(state(), std::pair(std::string("None"), 0));
  EXPECT_EQ(send(0, "New", {{"DiscardCurrentConfig", true}, {"LoadDefaultConfig", false}}), "");
  EXPECT_EQ(state(), std::pair(std::string("Incomplete"), 1));
  configure(0);
  EXPECT_EQ(state(), std::pair(std::string("Ready"), 2));
  engine_.stage = bench::EngineState::kArmed;
  EXPECT_EQ(state(), std::pair(std::string("Armed"), 8));
  engine_.stage = bench::EngineState::kStreaming;
  EXPECT_EQ(state(), std::pair(std::string("Streaming RF"), 5));
}

}  // namespace

}  // namespace vbar::grand::test
