// The registry of generators, and what their tables in a mission accept.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil_drivers/grand/wire/template_format.h"
#include "host_sim/mission/mission_error.h"
#include "host_sim/mission/toml_file.h"
#include "tests/unit/hil_drivers/grand/generators/loopback.h"

namespace vbar::grand::test {

namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string error_in(const GeneratorKind& kind, const std::string& text) {
  const toml::table table = mission::parse_toml(text, "t.toml");
  try {
    static_cast<void>(kind.read(mission::TableReader(table, "t.toml")));
  } catch (const mission::MissionError& error) {
    return error.what();
  }
  return "";
}

const GeneratorKind& kind_of(std::string_view name) {
  for (const GeneratorKind* kind : generator_kinds())
    if (kind->name == name) return *kind;
  throw std::logic_error("unknown kind");
}

TEST(GeneratorKinds, AreTheseThree) {
  std::vector<std::string_view> names;
  for (const GeneratorKind* kind : generator_kinds()) names.push_back(kind->name);
  EXPECT_THAT(names, ElementsAre("skydel", "simgen", "template"));
}

TEST(GeneratorKinds, RefuseUnknownKeys) {
  EXPECT_EQ(error_in(kind_of("skydel"), ""), "");
  EXPECT_EQ(error_in(kind_of("simgen"), ""), "");
  EXPECT_THAT(error_in(kind_of("skydel"), "radios = \"X300\""), HasSubstr("radios: found an unknown key"));
  EXPECT_THAT(error_in(kind_of("simgen"), "trigger_mode = 3"), HasSubstr("trigger_mode"));
}

const std::string kFields =
    "start_lines = [\"GO\"]\n"
    "fields = [ { value = \"time_s\", type = \"f64\" }, { value = \"vehicle\", type = \"u32\" },"
    "{ value = \"position_ecef_x\", type = \"f64\" }, { value = \"position_ecef_y\", type = \"f64\" }";

TEST(GeneratorKinds, ATemplateIsReadFromTheMission) {
  EXPECT_EQ(error_in(kind_of("template"), kFields + ", { value = \"position_ecef_z\", type = \"f64\", scale = 1e3 },"
                                                    "{ constant = 7, type = \"u8\" } ]\nbyte_order = \"big\"\n"),
            "");
}

TEST(GeneratorKinds, ATemplateNamesTheKnownNames) {
  const auto error = [](const std::string& field) {
    return error_in(kind_of("template"), kFields + ", " + field + " ]\n");
  };
  EXPECT_THAT(error("{ value = \"position_ecef_z\", type = \"f16\" }"),
              HasSubstr("u8, i8, u16, i16, u32, i32, u64, i64, f32 or f64"));
  EXPECT_THAT(error("{ value = \"position_z\", type = \"f64\" }"), HasSubstr("position_ecef_z"));
  EXPECT_THAT(error("{ value = \"yaw\", constant = 1, type = \"f64\" }"), HasSubstr("both value and constant"));
  EXPECT_THAT(error("{ value = \"yaw\", type = \"f64\" }"), HasSubstr("no position_ecef_z"));
  EXPECT_THAT(error("{ value = \"position_ecef_z\", type = \"f64\", scale = 0.0 }"), HasSubstr("the scale not 0"));
  EXPECT_THAT(error_in(kind_of("template"), "start_lines = \"GO\""), HasSubstr("an array of texts"));
  EXPECT_THAT(error_in(kind_of("template"), kFields + ", { constant = 300, type = \"u8\" } ]"),
              HasSubstr("300 does not fit"));
}

TEST(GeneratorKinds, NeedTheRightNumberOfPorts) {
  GeneratorPlan plan;
  plan.vehicles = {"servicer", "target"};
  plan.control_ports = {1};
  const toml::table table;
  const mission::TableReader section(table, "t.toml");
  const auto settings = kind_of("skydel").read(section);
  EXPECT_THAT(error_of([&] { static_cast<void>(kind_of("skydel").make(plan, *settings)); }),
              HasSubstr("1 control ports for 2 vehicles"));
}

}  // namespace

// The SimGEN driver and the emulated SimGEN.

namespace {

bench::ControlSettings simgen() {
  return {.protocol = bench::ControlProtocol::kSimgen};
}
const std::string kImpatient = "answer_limit_ms = 1500\n";

void fly(Generator& generator, int count) {
  for (int n = 1; n <= count; ++n) {
    for (const std::size_t vehicle : {0U, 1U}) {
      generator.send(vehicle, sample_at(tenths(n), static_cast<double>(vehicle)));
      EXPECT_GE(generator.wait_for(vehicle, tenths(n), soon()), tenths(n));
    }
  }
}

void expect_flown(Loopback& loopback, int count) {
  loopback.in_server([&](FakeEngine& engine, bench::ControlServers&) {
    for (const std::size_t vehicle : {0U, 1U}) {
      ASSERT_EQ(engine.samples[vehicle].size(), static_cast<std::size_t>(count) + 1);
      for (int n = 0; n <= count; ++n)
        EXPECT_TRUE(is_same(engine.samples[vehicle][n], sample_at(tenths(n), static_cast<double>(vehicle))));
    }
  });
}

TEST(SimgenLoopback, FliesBothVehiclesInLockStep) {
  Loopback loopback(simgen());
  const auto generator = loopback.generator("simgen");
  prepare(*generator);
  EXPECT_EQ(generator->start(), std::nullopt);
  fly(*generator, 20);
  EXPECT_EQ(generator->state(0).text, "Running");
  EXPECT_TRUE(generator->state(0).is_streaming);
  generator->stop();
  expect_flown(loopback, 20);
  loopback.in_server([](FakeEngine& engine, bench::ControlServers&) {
    EXPECT_EQ(engine.calls, "reset arm start stop ");
    EXPECT_EQ(engine.start_time, kStart);
  });
}

// In real time the motion goes by datagrams.
TEST(SimgenLoopback, FliesByDatagramsInRealTime) {
  Loopback loopback(simgen());
  const auto generator = loopback.generator("simgen", "", Pace::kRealTime);
  prepare(*generator);
  generator->start();
  fly(*generator, 20);
  expect_flown(loopback, 20);
}

TEST(SimgenLoopback, ALostSampleIsSentAgain) {
  Loopback loopback(simgen());
  const auto generator = loopback.generator("simgen");
  prepare(*generator);
  generator->start();
  fly(*generator, 1);
  loopback.in_server([](FakeEngine& engine, bench::ControlServers&) { engine.ignored_samples = 1; });
  generator->send(1, sample_at(tenths(2)));
  EXPECT_EQ(generator->wait_for(1, tenths(2), soon(5.0)), tenths(2));
}

TEST(SimgenLoopback, ARefusedCommandIsOneSentence) {
  for (const char* command : {"START_TIME", "AR", "MOT"}) {
    Loopback loopback(simgen());
    loopback.set_faults({.refused_command = command, .refusal = "Hardware not found"});
    const auto generator = loopback.generator("simgen");
    EXPECT_THAT(error_of([&] { prepare(*generator); }), AllOf(HasSubstr("SimGEN at 127.0.0.1:"), HasSubstr(command),
                                                              HasSubstr("answered the error \"Hardware not found\"")));
  }
}

TEST(SimgenLoopback, SilenceAndAClosedConnectionEndTheWait) {
  Loopback loopback(simgen());
  loopback.set_faults({.unanswered_command = "RU"});
  auto generator = loopback.generator("simgen", kImpatient);
  prepare(*generator);
  EXPECT_THAT(error_of([&] { generator->start(); }), HasSubstr("RU: no answer within 1.5 s"));
  generator->stop();
  loopback.set_faults({.closing_command = "TIME"});
  generator = loopback.generator("simgen", kImpatient);
  prepare(*generator);
  generator->start();
  EXPECT_THAT(error_of([&] { generator->wait_for(0, kTenth, soon()); }),
              HasSubstr("TIME: the generator closed the connection"));
}

TEST(SimgenLoopback, AWaitForAVehicleThatDoesNotMoveEnds) {
  Loopback loopback(simgen());
  const auto generator = loopback.generator("simgen");
  prepare(*generator);
  generator->start();
  EXPECT_EQ(generator->wait_for(0, kTenth, soon(0.3)), fsw::Duration{});
}

}  // namespace

// The template driver and the emulated generator of the same template.

namespace {

const std::string kLines = R"(
prepare_lines = ["DATE {year:04d}-{month:02d}-{day:02d}T{hour:02d}:{minute:02d}:{second:02d}"]
start_lines = ["ARM", "RUN {vehicles:d}"]
stop_lines = ["HALT"]
accepted_answer = "ACK"
progress_line = "WHERE {vehicle:d}"
progress_answer = "T {time_s:.4f}"
)";

const std::string kBinary = kLines + R"(
byte_order = "big"
fields = [
  { constant = 21930, type = "u16" }, { value = "vehicle", type = "u8" }, { value = "time_ms", type = "u32" },
  { value = "position_ecef_x", type = "f64" }, { value = "position_ecef_y", type = "f64" },
  { value = "position_ecef_z", type = "f64" }, { value = "velocity_ecef_x", type = "f64" },
  { value = "velocity_ecef_y", type = "f64" }, { value = "velocity_ecef_z", type = "f64" } ]
)";

// A literal TOML text, in which a backslash is one.
const std::string kText = kLines + R"(
text = '{time_s:.3f};{position_ecef_x};{position_ecef_y};{position_ecef_z};{yaw:.6f}\r\n'
vehicle = "port"
)";

bench::ControlSettings settings_of(const std::string& text) {
  const toml::table table = mission::parse_toml(text, "t.toml");
  return {.protocol = bench::ControlProtocol::kTemplate,
          .template_format = wire::read_template_format(mission::TableReader(table, "t.toml"))};
}

void send_samples(Generator& generator, int count) {
  for (int n = 1; n <= count; ++n) {
    for (const std::size_t vehicle : {0U, 1U}) {
      generator.send(vehicle, sample_at(tenths(n), static_cast<double>(vehicle)));
      EXPECT_EQ(generator.wait_for(vehicle, tenths(n), soon()), tenths(n));
    }
  }
}

TEST(TemplateLoopback, FliesBinaryAndTextDatagrams) {
  for (const std::string& text : {kBinary, kText}) {
    Loopback loopback(settings_of(text));
    EXPECT_EQ(loopback.control_ports().size(), text == kText ? 2U : 1U);
    const auto generator = loopback.generator("template", text);
    prepare(*generator);
    EXPECT_EQ(generator->start(), std::nullopt);
    send_samples(*generator, 10);
    EXPECT_EQ(generator->state(0).text, "at 1.000 s");
    generator->stop();
    loopback.in_server([&](FakeEngine& engine, bench::ControlServers&) {
      EXPECT_EQ(engine.calls, "reset arm start stop ");
      EXPECT_EQ(engine.start_time, kStart);
      for (const std::size_t vehicle : {0U, 1U}) {
        ASSERT_EQ(engine.samples[vehicle].size(), 11U);
        for (int n = 0; n <= 10; ++n) {
          const TrajectorySample sent = sample_at(tenths(n), static_cast<double>(vehicle));
          const TrajectorySample& got = engine.samples[vehicle][n];
          EXPECT_EQ(got.time, sent.time);
          EXPECT_EQ(got.position_ecef_m, sent.position_ecef_m);
          if (text == kBinary)
            EXPECT_EQ(got.velocity_ecef_mps, sent.velocity_ecef_mps);
          else
            EXPECT_NEAR(got.yaw_pitch_roll.x(), sent.yaw_pitch_roll.x(), 0.5e-6);  // as printed
        }
      }
    });
  }
}

TEST(TemplateLoopback, ALostSampleIsSentAgain) {
  Loopback loopback(settings_of(kBinary));
  const auto generator = loopback.generator("template", kBinary);
  prepare(*generator);
  generator->start();
  loopback.in_server([](FakeEngine& engine, bench::ControlServers&) { engine.ignored_samples = 1; });
  generator->send(0, sample_at(kTenth));
  EXPECT_EQ(generator->wait_for(0, kTenth, soon(5.0)), kTenth);
}

TEST(TemplateLoopback, RefusalSilenceAndClosingAreOneSentence) {
  const std::string text = kBinary + "answer_limit_ms = 1500\n";
  Loopback loopback(settings_of(kBinary));
  loopback.set_faults({.refused_command = "DATE 2011-07-19T16:00:00", .refusal = "No almanac"});
  auto generator = loopback.generator("template", text);
  EXPECT_THAT(error_of([&] { prepare(*generator); }),
              HasSubstr("DATE 2011-07-19T16:00:00: answered \"ERROR No almanac\""));
  loopback.set_faults({.unanswered_command = "ARM"});
  generator = loopback.generator("template", text);
  prepare(*generator);
  EXPECT_THAT(error_of([&] { generator->start(); }), HasSubstr("ARM: no answer within 1.5 s"));
  loopback.set_faults({.closing_command = "RUN 2"});
  generator = loopback.generator("template", text);
  prepare(*generator);
  EXPECT_THAT(error_of([&] { generator->start(); }), HasSubstr("RUN 2: the generator closed the connection"));
}

TEST(TemplateLoopback, LockStepNeedsAProgressLine) {
  std::string text = kBinary;
  text.replace(text.find("progress_line"), text.find("progress_answer") - text.find("progress_line"), "");
  Loopback loopback(settings_of(text));
  EXPECT_THAT(error_of([&] { static_cast<void>(loopback.generator("template", text)); }), HasSubstr("progress_line"));
  const auto generator = loopback.generator("template", text, Pace::kRealTime);
  prepare(*generator);
  generator->start();
  EXPECT_EQ(generator->wait_for(0, kTenth, soon()), std::nullopt);
  EXPECT_TRUE(generator->state(0).is_streaming);
}

}  // namespace

}  // namespace vbar::grand::test
