#include "tests/integration/pose/close_scene.h"

#include <array>
#include <cmath>
#include <stdexcept>

#include "fsw/measurements/keypoints/keypoint_settings.h"
#include "host_sim/installation/sensor_kinds.h"
#include "host_sim/mission/body_file.h"
#include "host_sim/mission/data_directory.h"
#include "host_sim/sensors/camera/camera_kind.h"
#include "host_sim/twins/camera/model/cad_objects.h"
#include "host_sim/twins/camera/photometry.h"
#include "tests/support/paths.h"

namespace vbar::test {
namespace {

using fsw::Vector3;

constexpr double kCameraRadiusM = 7087e3;

}  // namespace

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

}  // namespace vbar::test
