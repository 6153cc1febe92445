// Images that no recipe makes again, from the camera through log and replay: the first quarter of an hour of experiment
// 1 with a test double of a testbed in the place of the digital camera.

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <set>
#include <utility>

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "host_sim/files/output_file.h"
#include "host_sim/installation/sensor_kinds.h"
#include "host_sim/mission/mission.h"
#include "host_sim/mission/mission_document.h"
#include "host_sim/report/run_folder.h"
#include "host_sim/report/summary_json.h"
#include "host_sim/sensors/camera/make_camera.h"
#include "host_sim/simulation/assembly.h"
#include "host_sim/simulation/flight_computer.h"
#include "host_sim/simulation/recorded_mission.h"
#include "host_sim/simulation/recorders.h"
#include "host_sim/twins/camera/image_maker.h"
#include "host_sim/twins/camera/logged_image.h"
#include "pil_bridge/make_flight_computer.h"
#include "tests/support/paths.h"

namespace vbar::test {
namespace {

// A test double of an optical testbed: the digital image, with a pattern of pixels raised by a number that no image has
// had before.

class UnreproducibleTaker final : public twins::camera::ImageTaker {
 public:
  explicit UnreproducibleTaker(std::unique_ptr<twins::camera::ImageMaker> digital) : digital_(std::move(digital)) {}

  twins::camera::TakenImage take(const twins::camera::Exposure& exposure) override {
    static std::atomic<std::uint32_t> images{0};
    const std::uint32_t number = ++images;
    twins::camera::TakenImage image = digital_->take(exposure);
    const auto white = static_cast<std::uint32_t>((1 << digital_->settings().camera.detector.bits) - 1);
    // The bits of the number, small enough that the stars are still found.
    for (std::size_t k = 0; k < image.dn.size(); ++k)
      if ((number >> (k % 16U) & 1U) != 0)
        image.dn[k] = static_cast<std::uint16_t>(std::min<std::uint32_t>(image.dn[k] + 3U, white));
    image.notes.push_back({"test_image", static_cast<double>(number)});
    return image;
  }
  [[nodiscard]] std::vector<twins::Note> statistics() const override { return digital_->statistics(); }

 private:
  std::unique_ptr<twins::camera::ImageMaker> digital_;
};

}  // namespace
}  // namespace vbar::test

namespace vbar::app {
namespace {

namespace fs = std::filesystem;
using Overrides = std::vector<std::string>;

constexpr int kImages = 15;
const Overrides kShort{"mission.duration_h=0.25"};
const Overrides kHostProcess{"flight_computer.target=host_process", "flight_computer.link=udp"};

fs::path data() {
  return tests::source_path("data");
}

/// The sources of the mission, the camera's images taken by the test double.
sensors::MadeSources with_test_double(const mission::Mission& mission, const mission::Spacecraft& servicer,
                                      const fs::path& data_directory, twins::TruthOutlook* outlook) {
  sensors::MadeSources made = sensors::make_sources(mission, servicer, data_directory, outlook);
  for (const mission::Sensor& sensor : servicer.sensors) {
    if (sensor.kind != "camera") continue;
    auto taker = std::make_unique<test::UnreproducibleTaker>(
        sensors::make_digital_camera(mission, servicer, sensor, data_directory));
    const auto source = std::ranges::find(made.sources, sensors::source_name(servicer, sensor), &Source::name);
    source->packets = sensors::make_camera(mission, servicer, sensor, data_directory, std::move(taker));
  }
  return made;
}

/// Numbers of the images of which the flight software received a tile.
class UsedImages final : public RunObserver {
 public:
  void on_step(std::uint32_t, fsw::GpsTime, std::span<const pil::Packet> inputs,
               std::span<const pil::Packet>) override {
    for (const pil::Packet& packet : inputs)
      if (const auto tile = twins::tile_run_of(packet)) images.insert(tile->image);
  }
  std::set<std::int32_t> images;
};

/// That of the mission; the program of a process of its own stands in the build tree, not beside this one.
std::unique_ptr<pil::FlightComputer> connect(const mission::Mission& mission) {
  const mission::Spacecraft& servicer = flying_spacecraft(mission);
  if (servicer.flight_computer->target == mission::FlightTarget::kInProcess) return connect_flight_computer(servicer);
  pil::FlightComputerOptions options;
  options.target = pil::Target::kHostProcess;
  options.link = pil::link_from_name(mission::name_of(servicer.flight_computer->link));
  options.spacecraft = servicer.number;
  options.image = tests::build_path("vbar_flight");
  return pil::make_flight_computer(options);
}

struct Flown {
  report::Summary summary;
  std::set<std::int32_t> images_used;
};

/// As `vbar run`, with the test double; why it is incomplete is in the summary.
Flown fly(const fs::path& out, const Overrides& overrides) {
  const mission::Mission mission = sensors::load_mission(tests::source_path("missions/experiment1.toml"), overrides);
  AssembledMission assembled(mission, data(), with_test_double);
  report::RunRecord record;
  record.extensions = sensors::extensions();
  record.summary.mission = mission.name;
  record.summary.seed = mission.seed;
  report::RunFolder folder(out, record.summary, report::RunFolder::Existing::kRefuse, record.extensions);
  files::replace_text_file(out / kMissionCopy, mission::whole_mission_text(mission.file));
  std::string lines;
  for (const std::string& one : overrides) lines += one + "\n";
  files::replace_text_file(out / kOverridesCopy, lines);

  const auto computer = connect(mission);
  engine::SteadyWallClock wall;
  PacketRecorders keepers(mission, out);
  UsedImages used;
  std::vector<RunObserver*> observers(keepers.observers().begin(), keepers.observers().end());
  observers.push_back(&used);
  try {
    record.summary.complete = assembled.fly({*computer, wall, observers, {}, {}}, record);
    keepers.finish();
    computer->close();
  } catch (const std::exception& error) {
    record.summary.complete = false;
    record.summary.incomplete_reason = error.what();
  }
  record.summary.commands_sha256 = keepers.commands_sha256();
  record.summary.telemetry_sha256 = keepers.telemetry_sha256();
  return {record.summary, used.images};
}

struct Said {
  int code = -1;
  std::string text;
};

Said vbar(const std::string& arguments) {
  const std::string command = tests::build_path("vbar") + " " + arguments + " 2>&1";
  std::FILE* const pipe = ::popen(command.c_str(), "r");
  Said said;
  char part[256];
  while (std::fgets(part, sizeof part, pipe) != nullptr) said.text += part;
  const int status = ::pclose(pipe);
  said.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return said;
}

class RecordedImages : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / ("vbar_recorded_images_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  /// Flies into `name` and leaves a summary that a replay accepts.
  Flown fly_into(const std::string& name, Overrides overrides) {
    overrides.insert(overrides.end(), kShort.begin(), kShort.end());
    Flown flown = fly(folder_ / name, overrides);
    files::replace_text_file(report::summary_file(folder_ / name), report::summary_json(flown.summary, {}));
    return flown;
  }
  [[nodiscard]] Said replay(const std::string& name, const Overrides& overrides = {}) const {
    std::string arguments = "replay " + (folder_ / name).string();
    for (const std::string& one : overrides) arguments += " --set " + one;
    return vbar(arguments);
  }
  fs::path folder_;
};

void expect_identical(const Said& said) {
  EXPECT_EQ(said.code, 0) << said.text;
  EXPECT_NE(said.text.find("identical: "), std::string::npos) << said.text;
}

TEST_F(RecordedImages, ReplayToTheSameBits) {
  const Flown flown = fly_into("run", {});
  ASSERT_TRUE(flown.summary.complete) << flown.summary.incomplete_reason;
  EXPECT_EQ(flown.images_used.size(), static_cast<std::size_t>(kImages) - 1U) << "the last is still being read out";
  expect_identical(replay("run"));
  expect_identical(replay("run", kHostProcess));

  // They are other images than those of the same exposures by the digital camera, which the recipes still make.
  const twins::PacketLog log = twins::read_packet_log(report::packet_log_file(folder_ / "run"));
  ASSERT_EQ(log.recordings.size(), log.recipes.size());
  const mission::Mission mission = sensors::load_mission(tests::source_path("missions/experiment1.toml"), kShort);
  const mission::Spacecraft& servicer = flying_spacecraft(mission);
  const auto camera = std::ranges::find(servicer.sensors, "camera", &mission::Sensor::kind);
  const auto digital = sensors::make_digital_camera(mission, servicer, *camera, data());
  const auto recipe = twins::camera::recipe_of(log.recipes.at(0));
  ASSERT_TRUE(recipe);
  const std::vector<std::uint16_t> rendered = digital->take(recipe->exposure).dn;
  const std::vector<std::uint16_t> recorded = twins::camera::pixels_of_recorded_image(log.recordings.at(0).bytes);
  EXPECT_NE(rendered, recorded);
  for (std::size_t k = 0; k < recorded.size(); ++k) ASSERT_LE(std::abs(recorded[k] - rendered[k]), 3) << k;
  // Without the pattern of the test double, which is harder to predict than a camera's noise.
  const auto header = twins::camera::header_of_recorded_image(log.recordings.at(0).bytes);
  EXPECT_LT(twins::camera::recorded_image_of(header.value(), rendered).size(), 130'000U)
      << "the budget of an image; 0.28 GB for the 2159 of experiment 1";
}

TEST_F(RecordedImages, AreNotThoseOfAnotherRun) {
  const Flown one = fly_into("one", {}), other = fly_into("other", {});
  EXPECT_NE(one.summary.telemetry_sha256, other.summary.telemetry_sha256) << "they can be repeated by their log only";
  expect_identical(replay("one"));
}

TEST_F(RecordedImages, FlyInAProcessOfTheirOwn) {
  const Flown flown = fly_into("run", kHostProcess);
  ASSERT_TRUE(flown.summary.complete) << flown.summary.incomplete_reason;
  expect_identical(replay("run"));
}

TEST_F(RecordedImages, AreASourceOfAnotherRun) {
  const Flown flown = fly_into("run", {});
  const std::string camera = "spacecraft.servicer.sensors.camera.";
  const std::string again = (folder_ / "again").string();
  const Said said = vbar("run " + tests::source_path("missions/experiment1.toml") + " --quiet --out " + again +
                         " --set mission.duration_h=0.25 --set " + camera + "source=recorded --set " + camera +
                         "log=" + report::packet_log_file(folder_ / "run").string());
  ASSERT_EQ(said.code, 0) << said.text;
  const report::Summary summary = report::read_summary(report::summary_file(again));
  EXPECT_EQ(summary.telemetry_sha256, flown.summary.telemetry_sha256);
  EXPECT_EQ(summary.commands_sha256, flown.summary.commands_sha256);
  expect_identical(replay("again"));
}

TEST_F(RecordedImages, DamagedImageIsOneError) {
  ASSERT_TRUE(fly_into("run", {}).summary.complete);
  const fs::path file = report::packet_log_file(folder_ / "run");
  const twins::PacketLog log = twins::read_packet_log(file);
  const twins::ImagesOfLog::Recording& image = log.recordings.at(3);
  std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
  stream.seekp(static_cast<std::streamoff>(image.offset + image.bytes.size() / 2));
  const std::string damage(100, '\xFF');
  stream.write(damage.data(), static_cast<std::streamsize>(damage.size()));
  stream.close();
  const Said said = replay("run");
  EXPECT_NE(said.code, 0);
  EXPECT_NE(said.text.find(file.string() + ": image 3, at byte " + std::to_string(image.offset) +
                           ", holds damaged JPEG-LS data: "),
            std::string::npos)
      << said.text;
}

// RLIMIT_FSIZE stands for a full disk.
TEST_F(RecordedImages, ImageThatCannotBeRecordedIsNotUsed) {
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const rlimit limit{700'000, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &limit), 0);
  const Flown flown = fly_into("run", {});
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  const fs::path file = report::packet_log_file(folder_ / "run");
  EXPECT_FALSE(flown.summary.complete);
  EXPECT_EQ(flown.summary.incomplete_reason, file.string() + ": cannot be written: File too large");
  const twins::PacketLog log = twins::read_packet_log(file);
  std::set<std::int32_t> recorded;
  for (const auto& recording : log.recordings)
    recorded.insert(twins::camera::header_of_recorded_image(recording.bytes).value().key().image);
  EXPECT_FALSE(flown.images_used.empty());
  EXPECT_TRUE(std::ranges::includes(recorded, flown.images_used));
}

}  // namespace

}  // namespace vbar::app
