// What the flight software makes of whole images with the weights on board: of the target in good light, and of all
// that is not. The target's materials are those of its file, which no crop of the training had.

#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <random>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "fsw/measurements/keypoints/keypoint_settings.h"
#include "fsw/vision/pose/spacecraft_pose_network.h"
#include "host_sim/installation/sensor_kinds.h"
#include "host_sim/mission/body_file.h"
#include "host_sim/mission/data_file.h"
#include "host_sim/sensors/camera/camera_kind.h"
#include "host_sim/training/circumstances.h"
#include "host_sim/twins/camera/camera_settings.h"
#include "host_sim/twins/camera/detector.h"
#include "host_sim/twins/camera/model/cad_objects.h"
#include "host_sim/twins/camera/photometry.h"
#include "host_sim/twins/camera/scene.h"
#include "tests/support/paths.h"

namespace vbar::test {
namespace {

// Whole images of experiment 2's camera twin, and what the flight software makes of them with the weights on board.

/// What is before the camera, in its axes: z boresight, x right, y down. As it stands: the target eight metres ahead in
/// the middle, the Sun from behind the camera on the right, the Earth below and out of the field.
struct CloseView {
  fsw::pose::TargetPose pose{fsw::Matrix3::Identity(), fsw::Vector3(0.0, 0.0, 8.0)};
  fsw::Vector3 sun = fsw::Vector3(0.7, -0.2, -0.7).normalized();
  fsw::Vector3 nadir = fsw::Vector3(0.0, 1.0, -0.35).normalized();
  double sunlit = 1.0;
  double exposure = 1.0;  ///< times the mission's
  bool has_target = true;
  bool is_other = false;  ///< a ball of the target's size instead
};

/// Angle, rad, Sun to camera as the target sees it, the Sun turned about the line of sight by `turn`.
fsw::Vector3 sun_at_phase(const fsw::pose::TargetPose& pose, double phase, double turn);

/// Of the image's pose against the truth.
struct PoseMiss {
  double attitude_deg = 0.0;
  double position_share = 0.0;  ///< of the distance
};
class CloseScene {
 public:
  CloseScene();

  /// Pixels of the region that is read.
  const std::vector<std::uint16_t>& take(const CloseView& view);
  /// The flight software's answer to that image; `predicted`: as navigation would, or none.
  const fsw::pose::PoseSighting& look(const CloseView& view, const std::optional<fsw::Vector3>& predicted);

  [[nodiscard]] const twins::camera::CameraSettings& camera() const { return camera_; }

 private:
  twins::camera::CameraSettings camera_;
  training::TargetShape shape_;
  fsw::pose::PoseCameraSettings settings_;
  std::unique_ptr<fsw::pose::SpacecraftPoseNetwork> network_;
  std::unique_ptr<twins::camera::SceneRenderer> target_, other_;
  std::unique_ptr<twins::camera::Detector> detector_;
  twins::camera::PhotonImage photons_;
  std::vector<std::uint16_t> dn_;
  std::int32_t image_ = 0;
};

using fsw::Vector3;

constexpr double kCameraRadiusM = 7087e3;

Vector3 sun_at_phase(const fsw::pose::TargetPose& pose, double phase, double turn) {
  const Vector3 to_camera = -pose.position_camera_m.normalized();
  const Vector3 side = to_camera.cross(Vector3::UnitY()).normalized();
  const Vector3 around = std::cos(turn) * side + std::sin(turn) * to_camera.cross(side);
  return std::cos(phase) * to_camera + std::sin(phase) * around;
}

PoseMiss miss_of(const fsw::pose::PnpSolution& found, const fsw::pose::TargetPose& truth) {
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(found.pose.R_camera_body * truth.R_camera_body.transpose()));
  return {turn.angle() * 180.0 / M_PI,
          (found.pose.position_camera_m - truth.position_camera_m).norm() / truth.position_camera_m.norm()};
}

CloseScene::CloseScene()
    : shape_(training::TargetShape::load(mission::data_directory(), "tango")),
      network_(std::make_unique<fsw::pose::SpacecraftPoseNetwork>()) {
  const mission::Mission mission =
      sensors::load_mission(std::filesystem::path(vbar::tests::source_path("missions")) / "experiment2.toml");
  const mission::Spacecraft& servicer = *mission.find_spacecraft("servicer");
  const auto& sensor = *mission::find_settings<sensors::CameraSensor>(servicer);
  camera_ = sensor.settings;
  const auto settings = fsw::measurements::pose_camera_settings(
      sensors::camera_configuration_of(sensor), sensors::target_model_of(mission, sensor, mission::data_directory()));
  if (!settings.ok()) throw std::runtime_error("the mission's camera does not suit the flight software");
  settings_ = settings.value();
  network_->configure(settings_);
  const auto data = mission::data_directory();
  const std::array<std::string, 1> models{"tango"};
  const auto sources = mission::cad_sources_of(data, models);
  target_ = std::make_unique<twins::camera::SceneRenderer>(camera_, data, twins::camera::cad_objects(sources),
                                                           twins::camera::cad_covers(sources));
  other_ = std::make_unique<twins::camera::SceneRenderer>(camera_, data);
  detector_ = std::make_unique<twins::camera::Detector>(camera_, 5, "servicer/camera");
}

const std::vector<std::uint16_t>& CloseScene::take(const CloseView& view) {
  // Camera axes are ECI's.
  twins::camera::Exposure exposure;
  exposure.number = image_;
  exposure.camera_position_eci = -kCameraRadiusM * view.nadir;
  exposure.sun_eci = twins::camera::kAstronomicalUnit * view.sun + exposure.camera_position_eci;
  exposure.moon_eci = 3.8e8 * view.sun;
  exposure.years_since_j2000 = 11.5;
  if (view.has_target) {
    twins::camera::ObjectInView& object = exposure.objects.emplace_back();
    object.name = "target";
    object.model = view.is_other ? "sphere" : "tango";
    object.position_eci = view.pose.position_camera_m + view.pose.R_camera_body * shape_.model_origin;
    object.q_body_eci = Eigen::Quaterniond(view.pose.R_camera_body).conjugate();
    object.sunlit = view.sunlit;
  }
  photons_.region = camera_.region;
  photons_.electrons.assign(
      static_cast<std::size_t>(camera_.region.width) * static_cast<std::size_t>(camera_.region.height), 0.0F);
  (view.is_other ? *other_ : *target_).render(exposure, photons_);
  for (float& electrons : photons_.electrons) electrons *= static_cast<float>(view.exposure);
  detector_->expose(photons_, image_, dn_);
  return dn_;
}

const fsw::pose::PoseSighting& CloseScene::look(const CloseView& view, const std::optional<Vector3>& predicted) {
  take(view);
  return network_->process({}, image_++, {settings_.frame, dn_}, predicted);
}

using fsw::Vector3;
using fsw::pose::SightingStatus;

constexpr double kDegree = M_PI / 180.0;
constexpr double kRightDeg = 10.0;  // a pose farther off is wrong

CloseScene& scene() {
  static CloseScene one;
  return one;
}

/// Any attitude, 5 to 13 m ahead, near the middle.
fsw::pose::TargetPose drawn_pose(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Eigen::Quaterniond q;
  for (double& c : q.coeffs()) c = normal(random);
  const double depth = 9.0 + 4.0 * uniform(random);
  const double right = 0.03 * depth * uniform(random);
  const double down = 0.03 * depth * uniform(random);
  return {q.normalized().toRotationMatrix(), Vector3(right, down, depth)};
}

struct Tally {
  int images = 0;
  int poses = 0;
  int wrong = 0;
  int sure = 0;  ///< poses that a start would take: eight inliers, or a sigma of 3 deg
  int sure_wrong = 0;

  [[nodiscard]] double share(int of) const { return static_cast<double>(of) / images; }
  void print(const char* of) const {
    fmt::print("{}: {} images, {} poses, {} wrong; {} fit for a start, {} of them wrong\n", of, images, poses, wrong,
               sure, sure_wrong);
  }
};

using Change = std::function<void(CloseView&, std::mt19937_64&)>;

/// Images of drawn poses in drawn light of 35 to 110 deg phase, each changed by `change`, cut out where navigation
/// expects the target.
Tally tally(int images, std::uint64_t seed, const Change& change = {}) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  Tally tally;
  for (int k = 0; k < images; ++k) {
    CloseView view;
    view.pose = drawn_pose(random);
    const double phase = (35.0 + 75.0 * uniform(random)) * kDegree;
    // From the upper half of the sky: below is the Earth.
    view.sun = sun_at_phase(view.pose, phase, -M_PI * uniform(random));
    if (change) change(view, random);
    const auto& sighting = scene().look(view, view.pose.position_camera_m);
    ++tally.images;
    if (!sighting.pnp) continue;
    ++tally.poses;
    const double variance = sighting.pnp->covariance.topLeftCorner<3, 3>().trace() / 3.0;
    const bool is_sure = sighting.pnp->inliers >= 8 || std::sqrt(variance) < 3.0 * kDegree;
    const bool is_wrong = miss_of(*sighting.pnp, view.pose).attitude_deg > kRightDeg;
    tally.wrong += is_wrong ? 1 : 0;
    tally.sure += is_sure ? 1 : 0;
    tally.sure_wrong += is_sure && is_wrong ? 1 : 0;
  }
  return tally;
}

TEST(PoseImages, GoodLight) {
  const Tally found = tally(60, 1);
  found.print("good light");
  EXPECT_GE(found.share(found.poses), 0.85);
  EXPECT_LE(found.sure_wrong, 0.02 * found.sure + 1.0);
}

TEST(PoseImages, WithoutAPredictionTheTargetIsFoundInTheImage) {
  std::mt19937_64 random(2);
  int right = 0;
  constexpr int kImages = 30;
  for (int k = 0; k < kImages; ++k) {
    CloseView view;
    view.pose = drawn_pose(random);
    const auto& sighting = scene().look(view, std::nullopt);
    EXPECT_FALSE(sighting.region_is_predicted);
    right += sighting.pnp && miss_of(*sighting.pnp, view.pose).attitude_deg < kRightDeg ? 1 : 0;
  }
  EXPECT_GE(right, 20);
}

TEST(PoseImages, Eclipse) {
  std::mt19937_64 random(3);
  for (int k = 0; k < 10; ++k) {
    CloseView view;
    view.pose = drawn_pose(random);
    view.sunlit = 0.0;
    // The Sun is behind the Earth, which lies before the camera's feet and is dark.
    view.sun = view.nadir;
    for (const bool is_predicted : {false, true}) {
      const auto& sighting =
          scene().look(view, is_predicted ? std::optional(view.pose.position_camera_m) : std::nullopt);
      EXPECT_GE(sighting.status, SightingStatus::kNoKeypoints) << k;
      EXPECT_FALSE(sighting.pnp.has_value()) << k;
    }
  }
}

// A black outline with a bright rim, or a blinded image: few poses, and of those that count hardly one wrong.
TEST(PoseImages, SunBehindTheTarget) {
  const Tally found = tally(40, 4, [](CloseView& view, std::mt19937_64& random) {
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    const double phase = (140.0 + 40.0 * uniform(random)) * kDegree;
    view.sun = sun_at_phase(view.pose, phase, -M_PI * uniform(random));
  });
  found.print("Sun behind the target");
  EXPECT_LE(found.sure_wrong, 2);
}

TEST(PoseImages, EarthLimbBehindTheTarget) {
  const Tally found = tally(40, 5, [](CloseView& view, std::mt19937_64& random) {
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    // The limb, 64.2 deg from nadir, passes within 4 deg of the target, lit like it.
    const double down = (64.2 + 4.0 * uniform(random)) * kDegree;
    view.nadir = Vector3(0.0, std::sin(down), std::cos(down));
  });
  found.print("Earth limb behind the target");
  EXPECT_GE(found.share(found.poses - found.wrong), 0.5);
  EXPECT_LE(found.sure_wrong, 0.05 * found.sure + 1.0);
}

TEST(PoseImages, HalfOutsideTheField) {
  const Tally found = tally(40, 6, [](CloseView& view, std::mt19937_64&) {
    const double depth = view.pose.position_camera_m.z();
    // The left or the right edge of what is read: 400 px from the middle, 1450 px a unit of the tangent.
    view.pose.position_camera_m.x() = (view.pose.position_camera_m.x() > 0.0 ? 1.0 : -1.0) * depth * 400.0 / 1450.0;
  });
  found.print("half outside");
  EXPECT_LE(found.sure_wrong, 2);
}

// Keypoints where there is no image are none.
TEST(PoseImages, OutsideTheFieldThereAreNoKeypoints) {
  std::mt19937_64 random(7);
  for (int k = 0; k < 10; ++k) {
    CloseView view;
    view.pose = drawn_pose(random);
    view.pose.position_camera_m.x() = view.pose.position_camera_m.z() * 380.0 / 1450.0;
    const auto& sighting = scene().look(view, view.pose.position_camera_m);
    const auto& region = scene().camera().region;
    for (const auto& keypoint : sighting.keypoints) {
      if (!keypoint.is_usable) continue;
      EXPECT_LT(keypoint.pixel.x(), region.x + region.width + 10.0) << k;
    }
  }
}

TEST(PoseImages, BlankAndSaturated) {
  CloseView view;
  view.has_target = false;
  EXPECT_EQ(scene().look(view, std::nullopt).status, SightingStatus::kDark);
  EXPECT_EQ(scene().look(view, Vector3(0.0, 0.0, 8.0)).status, SightingStatus::kDark);
  // The Sun in the field, and the lens full of light.
  view.sun = Vector3(0.05, 0.0, 1.0).normalized();
  view.exposure = 1000.0;
  EXPECT_EQ(scene().look(view, std::nullopt).status, SightingStatus::kBlinded);
  EXPECT_EQ(scene().look(view, Vector3(0.0, 0.0, 8.0)).status, SightingStatus::kBlinded);
}

TEST(PoseImages, AnotherBodyIsNotTakenForTheTarget) {
  const Tally found = tally(40, 8, [](CloseView& view, std::mt19937_64&) { view.is_other = true; });
  found.print("a ball");
  EXPECT_LE(found.sure, 4);
}

}  // namespace

}  // namespace vbar::test
