// The template driver and the emulated generator of the same template.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil_drivers/grand/wire/template_settings.h"
#include "host_sim/mission/toml_file.h"
#include "tests/unit/hil_drivers/grand/generators/loopback.h"

namespace vbar::grand::test {
namespace {

using testing::HasSubstr;

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
