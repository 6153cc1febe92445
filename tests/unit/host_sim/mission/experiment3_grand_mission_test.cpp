// missions/experiment3_grand.toml explains every key of the GNSS testbed, the values it shows are the defaults, and
// combinations of keys that contradict each other are refused by one sentence.

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil_drivers/grand/settings.h"
#include "host_sim/sensors/gnss/gnss_kind.h"
#include "tests/support/paths.h"
#include "tests/unit/host_sim/mission/mission_text.h"
#include "tests/unit/host_sim/mission/shown_keys.h"

namespace vbar::mission::test {
namespace {

using grand::GrandSettings;
using ::testing::AllOf;
using ::testing::HasSubstr;

const std::string kExperiment3GrandFile = vbar::tests::source_path("missions/experiment3_grand.toml");
const std::string kLive = vbar::tests::source_path("missions/experiment3_grand_live.toml");

const GrandSettings& grand_of(const Mission& mission) {
  return dynamic_cast<const GrandSettings&>(*mission.testbeds.at(0).settings);
}

std::string refusal(const std::vector<std::string>& overrides, const std::string& file = kExperiment3GrandFile) {
  try {
    static_cast<void>(sensors::load_mission(file, overrides));
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

TEST(Experiment3GrandMission, EveryKeyOfTheTestbedIsExplained) {
  const std::string text = text_of_file(kExperiment3GrandFile);
  expect_all_shown(text, kExperiment3GrandFile, {"testbed.grand", "testbed.grand.skydel"});
}

TEST(Experiment3GrandMission, ShowsTheDefaults) {
  const Mission shown = sensors::load_mission(kExperiment3GrandFile);
  const Mission bare = sensors::parse_mission("extends = \"" + vbar::tests::source_path("missions/experiment3.toml") +
                                                  "\"\n[testbed.grand]\nbench = \"a bench\"\n",
                                              "bare.toml");
  const GrandSettings &a = grand_of(shown), &b = grand_of(bare);
  EXPECT_EQ(a.generator, b.generator);
  EXPECT_EQ(a.host, b.host);
  EXPECT_EQ(a.control_port, b.control_port);
  EXPECT_EQ(a.hil_port, b.hil_port);
  EXPECT_EQ(a.sample_period, b.sample_period);
  EXPECT_EQ(a.lead, b.lead);
  EXPECT_EQ(a.join, b.join);
  EXPECT_EQ(a.pace, b.pace);
  EXPECT_EQ(a.pps, b.pps);
  EXPECT_EQ(a.chrony, b.chrony);
  EXPECT_EQ(a.give_up, b.give_up);
  EXPECT_EQ(a.week_shift, b.week_shift);
  EXPECT_EQ(a.sample_period.ns, 100'000'000);  // the paper: 10 Hz
  const auto &line = sensor_of<sensors::GnssSensor>(shown).line, &other = sensor_of<sensors::GnssSensor>(bare).line;
  EXPECT_EQ(line.port, other.port);
  EXPECT_EQ(line.baud, other.baud);
  EXPECT_EQ(line.wired, other.wired);
  EXPECT_EQ(line.log_offset_s, other.log_offset_s);
  EXPECT_EQ(line.clock_adjust, other.clock_adjust);
  EXPECT_EQ(line.max_latency_s, other.max_latency_s);
}

TEST(Experiment3GrandMission, LiveFollowsTheWallClock) {
  const Mission live = sensors::load_mission(kLive);
  EXPECT_EQ(live.clock.mode, engine::ClockMode::kRealTime);
  EXPECT_EQ(live.clock.speed_factor, 1.0);
  EXPECT_EQ(live.duration, fsw::duration_of_seconds(120));
  EXPECT_EQ(grand_of(live).pace, grand::Pace::kRealTime);
  EXPECT_EQ(sensors::load_mission(kExperiment3GrandFile).clock.mode, engine::ClockMode::kLockStep);
}

TEST(Experiment3GrandMission, GnssSdrReceivesForTenMinutesInRealTime) {
  const Mission mission = sensors::load_mission(vbar::tests::source_path("missions/experiment3_grand_gnss_sdr.toml"));
  EXPECT_EQ(mission.clock.mode, engine::ClockMode::kRealTime);
  EXPECT_EQ(mission.duration, fsw::duration_of_seconds(600));
  EXPECT_THAT(grand_of(mission).bench, HasSubstr("--pace real_time --receiver gnss_sdr"));
  for (const char* const spacecraft : {"servicer", "target"}) {
    const auto& line = sensor_of<sensors::GnssSensor>(mission, spacecraft).line;
    EXPECT_EQ(line.log_offset_s, 8.0);
    EXPECT_EQ(line.max_latency_s, 1.95);
  }
}

TEST(Experiment3GrandMission, ContradictionsAreRefused) {
  EXPECT_THAT(refusal({"clock.mode=\"real_time\""}), AllOf(HasSubstr("clock.mode"), HasSubstr("testbed.grand.pace")));
  EXPECT_THAT(refusal({"clock.mode=\"lock_step\""}, kLive), HasSubstr("testbed.grand.pace"));
  EXPECT_THAT(refusal({"clock.speed_factor=2.0"}, kLive), HasSubstr("speed_factor"));
  EXPECT_THAT(refusal({"testbed.grand.lead_ms=20.0"}), AllOf(HasSubstr("lead_ms"), HasSubstr("lock_step")));
  EXPECT_THAT(refusal({"testbed.grand.pps=\"timer\""}), AllOf(HasSubstr("pps"), HasSubstr("lock_step")));
  EXPECT_THAT(refusal({"testbed.grand.pps=\"kernel\""}, kLive), HasSubstr("kernel:DEVICE"));
  EXPECT_THAT(refusal({"testbed.grand.rate_hz=3"}), HasSubstr("1, 2, 4, 5, 10, 20, 25 or 50"));
  EXPECT_THAT(refusal({"testbed.grand.generator=\"ifen\""}), AllOf(HasSubstr("skydel"), HasSubstr("template")));
  EXPECT_THAT(refusal({"spacecraft.servicer.sensors.gnss.max_latency_s=0.0"}), HasSubstr("max_latency_s"));
  EXPECT_THAT(refusal({"testbed.grand.bench=\"\""}), HasSubstr("control_port"));
  EXPECT_THAT(refusal({"spacecraft.target.sensors.gnss.source=\"digital\""}),
              AllOf(HasSubstr("source"), HasSubstr("target"), HasSubstr("sky")));
  EXPECT_THAT(refusal({"spacecraft.servicer.sensors.gnss.source=\"digital\""}), HasSubstr("source"));
  EXPECT_THAT(refusal({"spacecraft.target.sensors.gnss.wired=\"board\""}),
              AllOf(HasSubstr("wired"), HasSubstr("target has no flight computer")));
}

}  // namespace
}  // namespace vbar::mission::test
