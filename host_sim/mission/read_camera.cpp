#include "host_sim/mission/read_camera.h"

#include "host_sim/mission/camera_file.h"
#include "host_sim/mission/data_directory.h"
#include "host_sim/mission/names.h"
#include "host_sim/mission/read_attitude.h"

namespace vbar::mission {
namespace {

/// The twin is the one source so far: the key is there so that a testbed is one word away.
enum class CameraSource { kDigital };
constexpr Names<CameraSource, 1> kCameraSources{{{"digital", CameraSource::kDigital}}};

/// data/cameras holds one file each.
enum class CameraPreset { kOpticalStimulator, kTron };
constexpr Names<CameraPreset, 2> kCameraPresets{
    {{"optical_stimulator", CameraPreset::kOpticalStimulator}, {"tron", CameraPreset::kTron}}};

constexpr Names<CameraNavigation, 2> kCameraNavigations{
    {{"angles_only", CameraNavigation::kAnglesOnly}, {"pose", CameraNavigation::kPose}}};

}  // namespace

CameraSensor read_camera(const TableReader& section, const std::string& own, const std::vector<std::string>& names,
                         const Mission& mission) {
  section.accept_only({"source", "camera", "target", "navigation", "period_s", "readout_s", "q_camera_body",
                       "position_body_m", "exposure_s", "region_px", "zero_magnitude_photons", "optics", "detector"});
  static_cast<void>(section.choice<CameraSource>("source", kCameraSources, CameraSource::kDigital));
  CameraSensor camera;
  camera.camera =
      name_in(kCameraPresets, section.choice<CameraPreset>("camera", kCameraPresets, CameraPreset::kOpticalStimulator));
  CameraFile file = load_camera(data_directory() / "cameras" / (camera.camera + ".toml"));
  read_camera_settings(section, file);
  camera.settings = file.settings();
  camera.target = read_other_spacecraft(section, own, names);
  camera.navigation = section.choice<CameraNavigation>("navigation", kCameraNavigations, CameraNavigation::kAnglesOnly);
  camera.period = section.span("period_s", 1.0, from_to(0.1, 3600.0), fsw::seconds(mission.step));
  camera.readout = section.span("readout_s", 1.0, from_to(0.0, 3600.0), 2.0);
  if (fsw::seconds(camera.readout) + camera.settings.exposure_s > fsw::seconds(camera.period))
    section.refuse(section.has("readout_s") ? "readout_s" : "period_s",
                   "images that come faster than one is exposed and read",
                   "exposure_s and readout_s that fit into period_s");
  if (const auto q = read_quaternion(section, "q_camera_body")) camera.q_camera_body = *q;
  const auto position = section.three_numbers("position_body_m", from_to(-50.0, 50.0), {{0.0, 0.0, 0.0}});
  camera.position_body_m = {position[0], position[1], position[2]};
  return camera;
}

}  // namespace vbar::mission
