#include <algorithm>
#include <filesystem>

#include "host_sim/mission/names.h"
#include "host_sim/mission/nearest_name.h"
#include "host_sim/mission/read_attitude.h"
#include "host_sim/sensors/camera/camera_file.h"
#include "host_sim/sensors/camera/camera_kind.h"

namespace vbar::sensors {
namespace {

using mission::from_to;
using mission::TableReader;

constexpr mission::Names<CameraNavigation, 3> kCameraNavigations{{{"none", CameraNavigation::kNone},
                                                                  {"angles_only", CameraNavigation::kAnglesOnly},
                                                                  {"pose", CameraNavigation::kPose}}};

std::vector<std::string> names_in(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error))
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

/// A name: the file of that name in data/cameras. A path that begins with "./" or "../", or an absolute one: that file,
/// seen from the mission file.
std::filesystem::path camera_file(const TableReader& section, const std::string& camera,
                                  const mission::SensorContext& context) {
  if (camera.starts_with("./") || camera.starts_with("../") || camera.starts_with("/"))
    return std::filesystem::absolute(context.mission.file).parent_path() / camera;
  const std::filesystem::path folder = context.installation.data_directory / "cameras";
  const std::vector<std::string> names = names_in(folder);
  if (std::find(names.begin(), names.end(), camera) == names.end()) {
    const std::vector<std::string_view> accepted(names.begin(), names.end());
    const auto nearest = mission::nearest_name(camera, accepted);
    section.refuse(
        "camera",
        "the text \"" + camera + "\"" + (nearest ? " (did you mean " + std::string(*nearest) + "?)" : std::string()),
        mission::listing_of(accepted) + ", or the path of a camera file (./...)");
  }
  return folder / (camera + ".toml");
}

}  // namespace

std::shared_ptr<const mission::SensorSettings> read_camera(const TableReader& section,
                                                           const mission::SensorContext& context) {
  auto sensor = std::make_shared<CameraSensor>();
  CameraSensor& camera = *sensor;
  mission::read_source(section, "digital", context, camera);
  camera.camera = section.text("camera", "optical_stimulator");
  CameraFile file = load_camera(camera_file(section, camera.camera, context));
  read_camera_settings(section, file);
  camera.settings = file.settings();
  camera.observed = mission::read_other_spacecraft(section, context.spacecraft, context.spacecraft_names);
  camera.use = section.choice<CameraNavigation>("navigation", kCameraNavigations, CameraNavigation::kAnglesOnly);
  constexpr std::int32_t kUses[] = {0, vbar::navigation_configuration::kUseBearings,
                                    vbar::navigation_configuration::kUseKeypoints};
  camera.navigation = kUses[static_cast<std::size_t>(camera.use)];
  camera.period = section.span("period_s", 1.0, from_to(0.1, 3600.0), fsw::seconds(context.mission.step));
  camera.readout = section.span("readout_s", 1.0, from_to(0.0, 3600.0), 2.0);
  if (const auto q = mission::read_quaternion(section, "q_camera_body")) camera.q_camera_body = *q;
  const auto position = section.three_numbers("position_body_m", from_to(-50.0, 50.0), {{0.0, 0.0, 0.0}});
  camera.position_body_m = {position[0], position[1], position[2]};
  section.finish();
  if (fsw::seconds(camera.readout) + camera.settings.exposure_s > fsw::seconds(camera.period))
    section.refuse(section.has("readout_s") ? "readout_s" : "period_s",
                   "images that come faster than one is exposed and read",
                   "exposure_s and readout_s that fit into period_s");
  return sensor;
}

}  // namespace vbar::sensors
