// Through all of the bench: robots move, motion capture states where they are, lights shine, a GigE Vision client takes
// the image.

#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>

#include <gmock/gmock.h>

#include "hil_drivers/gige/camera/camera.h"
#include "hil_drivers/tron/geometry/kinematics.h"
#include "hil_drivers/tron/protocols/sacn.h"
#include "hil_drivers/tron/protocols/vicon_receiver.h"
#include "tests/support/figures.h"
#include "tests/unit/emulators/tron/process/bench_process.h"

namespace vbar::tron::bench {
namespace {

using test::kPatience;
using test::TwoRobots;
using ::testing::HasSubstr;

constexpr twins::camera::Region kRegion{160, 100, 1600, 1000};
constexpr int kFrames = 20;

struct Session {
  std::vector<std::uint16_t> lit, dark;
  vicon::CaptureAverage capture;
  std::string truth;
};

class TronBenchImage : public test::BenchProcessTest {
 protected:
  TronBenchImage() {
    laboratory = read_testbed_design(mission::data_directory() / "benches" / "tron.toml");
    laboratory.vicon.port = 0;
  }

  /// The camera's robot with the camera 3 m before the mock-up.
  rsi::AxisPositions facing(const Joints& target_rad) {
    constexpr double kCarriage_m = 2.9, kDistance_m = 3.0;
    const ArmPair arms(laboratory);
    Posture posture;
    posture.target_rad = target_rad;
    Eigen::Isometry3d T_L_C = Eigen::Isometry3d::Identity();
    T_L_C.linear() << 0, 0, 1, 0, -1, 0, 1, 0, 0;
    T_L_C.translation() = arms.target_pose(posture).translation() - kDistance_m * fsw::Vector3::UnitX();
    const Joints home = Eigen::Map<const Joints>(laboratory.camera_robot.home_rad.data());
    const Branches branches = arms.camera_arm().inverse(arms.camera_flange(T_L_C, kCarriage_m), home);
    rsi::AxisPositions axes{home, kCarriage_m - laboratory.track.home_m};
    double nearest = 1e9;
    for (std::size_t k = 0; k < branches.count; ++k) {
      const double turn = (branches.joints[k] - home).norm();
      if (!branches.is_within_limits[k] || turn >= nearest) continue;
      nearest = turn;
      axes.axes_rad = branches.joints[k];
    }
    EXPECT_LT(nearest, 3.0);
    return axes;
  }

  gige::Frame take(gige::Camera& camera) {
    std::string reason;
    for (int tries = 0; tries < 5; ++tries) {  // a loaded machine may lose packets
      auto result = camera.take();
      if (auto* frame = std::get_if<gige::Frame>(&result)) return std::move(*frame);
      reason = std::get<gige::NoFrame>(result).text;
    }
    throw std::runtime_error("no image in five tries: " + reason);
  }

  void light(const nlohmann::json& where, std::uint16_t lamp, std::uint16_t box) {
    if (!sender) {
      SacnSettings settings = laboratory.sacn;
      const std::string address = where.get<std::string>();
      settings.address = address.substr(0, address.find(':'));
      settings.port = static_cast<std::uint16_t>(std::stoi(address.substr(address.find(':') + 1)));
      sender = std::make_unique<sacn::Sender>(settings, laboratory.name);
    }
    std::array<std::uint16_t, 2 + kBoxes> values{};
    values.fill(box);
    values[0] = lamp;
    values[1] = 32768;
    sender->send(values);
  }

  Session run(const std::vector<std::string>& more = {}) {
    Session session;
    TwoRobots robots;
    vicon::Receiver receiver(laboratory.vicon);
    std::vector<std::string> arguments = more;
    arguments.insert(arguments.end(), {"--seed", "3", "--vicon-port", std::to_string(receiver.port())});
    start(robots, arguments);
    robots.open(addresses);
    const rsi::AxisPositions target = robots.target().last_command();
    robots.move_to(1000, facing(target.axes_rad), target);
    light(addresses.at("sacn"), 65535, 20000);
    robots.hold(60);
    receiver.clear();
    robots.hold(5 * kFrames / 2 + 3);
    receiver.drain();
    session.capture = receiver.average(kFrames, {});
    gige::Camera::Settings settings;
    settings.address = addresses.at("camera").get<std::string>();
    settings.region = kRegion;
    settings.exposure_s = 0.5e-3;
    settings.timeout_s = 60.0;
    gige::Camera camera(settings);
    camera.open();
    session.lit = take(camera).dn;
    light(addresses.at("sacn"), 0, 0);
    robots.hold(1);
    session.dark = take(camera).dn;
    camera.close();
    sender.reset();
    end();
    session.truth = text_of("truth.csv");
    return session;
  }

  static double mean_of(const std::vector<std::uint16_t>& dn) {
    return std::accumulate(dn.begin(), dn.end(), 0.0) / static_cast<double>(dn.size());
  }

  /// The number that one pixel in a thousand exceeds.
  static double brightest(const std::vector<std::uint16_t>& dn) {
    return accuracy::quantile({dn.begin(), dn.end()}, 0.999);
  }

  TestbedDesign laboratory;
  std::unique_ptr<sacn::Sender> sender;
};

TEST_F(TronBenchImage, TheSameSeedGivesTheSameBitsTwice) {
  const Session first = run(), second = run();
  ASSERT_EQ(first.lit.size(), 1'600'000U);
  EXPECT_EQ(first.lit, second.lit);
  EXPECT_EQ(first.dark, second.dark);
  EXPECT_EQ(first.truth, second.truth);
  EXPECT_EQ(first.capture.camera.T_V_object.matrix(), second.capture.camera.T_V_object.matrix());
  // The light of lamp and boxes is in the image; without it there is the offset of 64 and noise.
  EXPECT_GT(brightest(first.lit), 300.0);
  EXPECT_NEAR(mean_of(first.dark), 64.0, 3.0);
  EXPECT_TRUE(first.capture.is_tracked());
  EXPECT_EQ(first.capture.camera.frames, kFrames);
}

TEST_F(TronBenchImage, ALampOutDarkensTheImagesOfItsFault) {
  const Session whole = run();
  const std::string faults = directory.path() / "faults_given.jsonl";
  std::ofstream(faults) << R"({"kind": "lamp_out", "at_image": 0, "images": 1})"
                        << "\n";
  const Session without = run({"--faults", faults});
  EXPECT_LT(brightest(without.lit), 0.7 * brightest(whole.lit));
  EXPECT_EQ(without.dark, whole.dark);
  EXPECT_THAT(text_of("faults.jsonl"), HasSubstr(R"({"kind":"lamp_out","image":0)"));
}

TEST_F(TronBenchImage, TruthHasARowForEachExposure) {
  const Session session = run();
  std::istringstream rows(session.truth);
  std::string header, first, second, more;
  std::getline(rows, header);
  std::getline(rows, first);
  std::getline(rows, second);
  EXPECT_FALSE(std::getline(rows, more));
  EXPECT_EQ(std::ranges::count(header, ','), std::ranges::count(first, ','));
  EXPECT_EQ(first.substr(0, 2), "0,");
  EXPECT_EQ(second.substr(0, 2), "1,");
  EXPECT_THAT(first, HasSubstr(",target,"));
}

}  // namespace
}  // namespace vbar::tron::bench
