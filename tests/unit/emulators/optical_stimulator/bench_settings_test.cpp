// The file of the bench: its defaults, and errors that name the key.

#include <fstream>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "emulators/optical_stimulator/fault_list.h"
#include "emulators/optical_stimulator/optical_path.h"
#include "emulators/optical_stimulator/settings.h"
#include "host_sim/mission/mission_error.h"
#include "tests/unit/emulators/optical_stimulator/bench_fixture.h"

namespace vbar::optical_stimulator::bench {

namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

std::filesystem::path bench_file() {
  return mission::data_directory() / "benches/optical_stimulator.toml";
}

TEST(BenchSettings, DefaultsAreThoseOfTheDesign) {
  const BenchSettings bench = test::default_bench();
  EXPECT_NEAR(bench.lenses.focal_length_mm(), 57.1, 0.05);
  EXPECT_EQ(bench.pose.pitch_um, 9.6);
  EXPECT_EQ(bench.pose.shift_mm, (std::array{0.13, -0.09}));
  EXPECT_EQ(bench.pose.turn_mrad, 2.5);
  EXPECT_EQ(bench.pose.tilt_mrad, (std::array{4.0, -6.0}));
  EXPECT_EQ(bench.optics.distortion, (std::array{-0.9, 3.0, 1e-3, -7e-4}));
  EXPECT_EQ(bench.field.waves, 60);
  EXPECT_EQ(bench.field.direction_arcsec, 15.0);
  EXPECT_EQ(bench.light.full_luminance, 200.0);
  EXPECT_EQ(bench.light.gamma, 2.2);
  EXPECT_EQ(bench.light.first_count, 3.0);
  EXPECT_EQ(bench.light.contrast, 1e5);
  EXPECT_EQ(bench.rails.microstep_um, 0.047625);
  EXPECT_EQ(bench.drift.day, 0);
}

TEST(BenchSettings, EveryValueThatTheFileShowsIsTheDefault) {
  std::ifstream in(bench_file());
  std::stringstream text;
  for (std::string line; std::getline(in, line);)
    text << std::regex_replace(line, std::regex("^# ([a-z0-9_]+ = |\\[\\[)"), "$1") << "\n";
  const std::string shown = text.str();
  ASSERT_THAT(shown, HasSubstr("\npitch_um = 9.6"));
  const std::string path = testing::TempDir() + "vbar_shown_bench.toml";
  std::ofstream(path) << shown;
  const BenchSettings a = read_bench(path, {}), b;
  std::filesystem::remove(path);
  const auto numbers = [](const BenchSettings& s) {
    return std::vector<double>{static_cast<double>(s.seed),
                               static_cast<double>(s.pace),
                               s.noise ? 1.0 : 0.0,
                               s.lenses.f1_mm,
                               s.lenses.f2_mm,
                               s.optics.distortion[0],
                               s.optics.distortion[3],
                               s.optics.coma_px,
                               s.optics.point_spread_sigma_px,
                               s.optics.camera_turn_mrad[1],
                               static_cast<double>(s.field.waves),
                               s.field.wave_length_px,
                               s.field.direction_arcsec,
                               s.field.light,
                               static_cast<double>(s.display.width),
                               static_cast<double>(s.display.height),
                               s.pose.pitch_um,
                               s.pose.shift_mm[1],
                               s.pose.turn_mrad,
                               s.pose.tilt_mrad[1],
                               s.light.full_luminance,
                               s.light.gamma,
                               s.light.first_count,
                               s.light.contrast,
                               s.light.pixel_unevenness,
                               s.display.refresh_hz,
                               static_cast<double>(s.display.latency_frames),
                               s.display.response_ms,
                               s.camera.gain_factor,
                               s.camera.read_noise_factor,
                               s.camera.offset_dn,
                               static_cast<double>(s.camera.hot_pixels),
                               s.rails.microstep_um,
                               s.rails.backlash_um,
                               s.rails.repeatability_um,
                               s.rails.travel_mm,
                               s.rails.lens_zero_mm,
                               s.rails.display_zero_mm,
                               s.rails.zero_error_mm,
                               s.rails.speed_mm_s,
                               static_cast<double>(s.drift.day),
                               s.drift.day_shift_um,
                               s.drift.day_scale_ppm,
                               s.drift.run_shift_um,
                               s.drift.run_scale_ppm,
                               static_cast<double>(s.drift.run_frames)};
  };
  EXPECT_EQ(numbers(a), numbers(b));
  ASSERT_EQ(a.faults.size(), 1U);
  EXPECT_EQ(a.faults[0].kind, FaultKind::kLateFrame);
  EXPECT_EQ(a.faults[0].frame, 100U);
  EXPECT_EQ(a.camera.file, b.camera.file);
  EXPECT_EQ(a.identity.model, b.identity.model);
}

TEST(BenchSettings, ErrorsNameFileKeyAndRange) {
  const auto with = [](const std::string& assignment) {
    return [assignment] { (void)read_bench(bench_file(), {assignment}); };
  };
  EXPECT_THAT(with("display.gama=2"),
              ThrowsMessage<mission::MissionError>(AllOf(HasSubstr("display.gama"), HasSubstr("did you mean gamma"))));
  EXPECT_THAT(with("display.gamma=nan"), ThrowsMessage<mission::MissionError>(HasSubstr("display.gamma: found nan")));
  EXPECT_THAT(with("lenses.f1_mm=0"), ThrowsMessage<mission::MissionError>(HasSubstr("lenses.f1_mm: found")));
  EXPECT_THAT(with("display.shift_mm=[1.0]"), ThrowsMessage<mission::MissionError>(HasSubstr("display.shift_mm")));
  EXPECT_THAT(with("drift.day=-1"), ThrowsMessage<mission::MissionError>(HasSubstr("drift.day")));
  EXPECT_THAT(with("pace=slow"), ThrowsMessage<mission::MissionError>(HasSubstr("real or fast")));
  EXPECT_THAT([] { (void)read_bench("/does/not/exist.toml", {}); },
              ThrowsMessage<mission::MissionError>(HasSubstr("/does/not/exist.toml")));
}

TEST(BenchSettings, TheCameraIsThatOfItsFileWithErrors) {
  const auto camera = camera_of(test::default_bench(), mission::data_directory());
  EXPECT_NEAR(camera.detector.gain_dn_per_electron, 0.125 * 1.03, 1e-15);
  EXPECT_NEAR(camera.detector.read_noise_electrons, 7.7, 1e-12);
  EXPECT_NEAR(camera.detector.offset_dn, 66.0, 1e-12);
  EXPECT_EQ(camera.region, (twins::camera::Region{0, 0, 1920, 1200}));
}

TEST(Drift, IsThatOfTheDayAndGrowsInTheSession) {
  const DriftSettings day0, day1{1, 1.0, 20.0, 0.5, 5.0, 2159};
  const Displacement start = drift_at(day0, 1, 0), end = drift_at(day0, 1, 100000);
  EXPECT_EQ(start.um, (std::array{0.0, 0.0}));
  EXPECT_NEAR(std::hypot(end.um[0], end.um[1]), 0.5, 1e-12);
  EXPECT_NEAR(std::abs(end.scale_ppm), 5.0, 1e-12);
  const Displacement day = drift_at(day1, 1, 0);
  EXPECT_NEAR(std::hypot(day.um[0], day.um[1]), 1.0, 1e-12);
  EXPECT_NEAR(std::abs(day.scale_ppm), 20.0, 1e-12);
  EXPECT_EQ(drift_at(day1, 1, 64).um, drift_at(day1, 1, 127).um);
  EXPECT_NE(drift_at(day1, 1, 63).um, drift_at(day1, 1, 64).um);
}

}  // namespace

// Faults: their lines, when they begin and end, and when they are acknowledged.

namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class FaultListTest : public ::testing::Test {
 protected:
  FaultListTest() {
    FaultActions actions;
    actions.camera = [this](const Fault& fault, bool on) {
      events.push_back(std::string(rule_of(fault.kind).name) + (on ? " on" : " off"));
    };
    actions.bump = [this](double x, double) { events.push_back("bump " + std::to_string(x)); };
    actions.stall_rail = [this](std::size_t axis) { events.push_back("stall " + std::to_string(axis)); };
    actions.move_rail = [this](std::size_t axis, double) { events.push_back("move " + std::to_string(axis)); };
    actions.rail_stalls = [this](std::size_t) { return stalls; };
    actions.exit = [this] { events.push_back("exit"); };
    list.emplace(actions, file);
  }
  ~FaultListTest() override { std::remove(file.c_str()); }

  void add(const std::string& line, double now_s = 0.0) {
    list->add(fault_from_json(line), now_s, [this](const std::string& text) { acknowledged.push_back(text); });
  }
  ExposureFaults expose(std::uint64_t frame) {
    const ExposureFaults faults = list->begin_exposure(frame, 0.0);
    list->end_exposure(frame);
    return faults;
  }

  std::string file = testing::TempDir() + "vbar_os_faults.jsonl";
  std::vector<std::string> events, acknowledged;
  std::uint64_t stalls = 0;
  std::optional<FaultList> list;
};

TEST_F(FaultListTest, ALateFrameAtItsNumberForItsLength) {
  add(R"({"kind": "late_frame", "frame": 2, "frames": 2})");
  std::vector<bool> late;
  for (std::uint64_t frame = 0; frame < 6; ++frame) {
    if (frame == 2) {
      EXPECT_THAT(acknowledged, IsEmpty());
    }
    late.push_back(expose(frame).panel.is_late);
  }
  EXPECT_THAT(late, ElementsAre(false, false, true, true, false, false));
  EXPECT_THAT(acknowledged, ElementsAre(R"({"kind":"late_frame","frame":2})"));
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  EXPECT_EQ(line, R"({"kind":"late_frame","frame":2})");
}

TEST_F(FaultListTest, WithoutANumberFromTheNextExposureToTheEnd) {
  (void)expose(0);
  add(R"({"kind": "brightness", "factor": 0.9})");
  EXPECT_THAT(acknowledged, IsEmpty());
  for (std::uint64_t frame = 1; frame < 5; ++frame) EXPECT_DOUBLE_EQ(expose(frame).brightness_factor, 0.9);
  EXPECT_EQ(acknowledged.size(), 1U);
}

TEST_F(FaultListTest, TheCameraReturnsAfterItsTime) {
  add(R"({"kind": "camera_away", "duration_s": 2.0})", 10.0);
  list->advance(11.9);
  EXPECT_THAT(events, ElementsAre("camera_away on"));
  list->advance(12.0);
  list->advance(13.0);
  EXPECT_THAT(events, ElementsAre("camera_away on", "camera_away off"));
}

TEST_F(FaultListTest, AStalledRailIsAcknowledgedWhenAMoveHasStalled) {
  add(R"({"kind": "rail_stalled", "axis": 2})");
  EXPECT_THAT(events, ElementsAre("stall 1"));
  EXPECT_THAT(acknowledged, IsEmpty());
  stalls = 1;
  list->advance(1.0);
  EXPECT_THAT(acknowledged, ElementsAre(HasSubstr(R"("axis":2)")));
}

TEST_F(FaultListTest, HostileLinesAreOneError) {
  for (const char* line : {"", "{}", "[]", "{\"kind\": 5}", R"({"kind": "nothing"})", R"({"kind": "gain"})",
                           R"({"kind": "gain", "factor": -1})", R"({"kind": "late_frame", "frames": -1})",
                           R"({"kind": "late_frame", "count": 1})", R"({"kind": "rail_moved", "axis": 3, "by_um": 1})",
                           R"({"kind": "bumped", "x_um": true})"})
    EXPECT_THAT([&] { (void)fault_from_json(line); },
                ThrowsMessage<mission::MissionError>(HasSubstr("fault control line")))
        << line;
}

TEST(Panel, ShowsWhatItsFaultsMakeOfTheScreen) {
  const auto picture = [](std::uint8_t first) {
    return Pictures{
        {std::make_shared<const std::vector<std::uint8_t>>(std::vector<std::uint8_t>{first, 1, 2, 3, 4, 5, 6, 7}),
         1.0}};
  };
  const auto shown = [](const Pictures& pictures) { return *pictures.front().counts; };
  Panel panel(4, 2);
  PanelFaults none, late, frozen, mirrored, rotated, covered;
  late.is_late = frozen.is_frozen = mirrored.is_mirrored = rotated.is_rotated = covered.is_covered = true;
  EXPECT_EQ(shown(panel.show(picture(10), none))[0], 10);
  EXPECT_EQ(shown(panel.show(picture(20), late))[0], 10);
  EXPECT_EQ(shown(panel.show(picture(20), none))[0], 20);
  EXPECT_EQ(shown(panel.show(picture(30), frozen))[0], 20);
  EXPECT_EQ(shown(panel.show(picture(40), frozen))[0], 20);
  EXPECT_EQ(shown(panel.show(picture(50), none))[0], 50);
  EXPECT_THAT(shown(panel.show(picture(0), mirrored)), ElementsAre(3, 2, 1, 0, 7, 6, 5, 4));
  EXPECT_THAT(shown(panel.show(picture(0), rotated)), ElementsAre(7, 6, 5, 4, 3, 2, 1, 0));
  EXPECT_THAT(shown(panel.show(picture(0), covered)), ElementsAre(0, 128, 128, 3, 4, 5, 6, 7));
}

}  // namespace

}  // namespace vbar::optical_stimulator::bench
