#include <algorithm>
#include <filesystem>

#include "host_sim/mission/data_file.h"
#include "host_sim/mission/names.h"
#include "host_sim/mission/nearest_name.h"
#include "host_sim/mission/read_attitude.h"
#include "host_sim/mission/read_cadence.h"
#include "host_sim/sensors/camera/camera_file.h"
#include "host_sim/sensors/camera/camera_kind.h"

namespace vbar::sensors {
namespace {

using mission::from_to;
using mission::TableReader;

constexpr mission::Names<std::int32_t, 3> kUses{
    {{"none", 0}, {"angles_only", CameraSensor::kBearings}, {"pose", CameraSensor::kKeypoints}}};

/// One of the names, or an array of "angles_only" and "pose".
std::int32_t read_uses(const TableReader& section) {
  if (!section.is_array("navigation"))
    return section.choice<std::int32_t>("navigation", kUses, CameraSensor::kBearings);
  std::int32_t uses = 0;
  for (const std::int32_t use : section.choices<std::int32_t>("navigation", kUses)) {
    if (use == 0) section.refuse_value("navigation", "\"none\" alone");
    uses |= use;
  }
  return uses;
}

/// Keypoints want a target that is not saturated, bearings want stars: a camera with both uses has two exposures.
double read_keypoint_exposure(const TableReader& section, const CameraSensor& camera) {
  if (!camera.changes_use()) return camera.settings.exposure_s;
  return section.number("exposure_keypoints_s", from_to(1e-6, camera.settings.exposure_s));
}

std::vector<std::string> names_in(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error))
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

/// A name: the file of that name in data/cameras. A path that begins with "./" or "../", or an absolute one: that file,
/// seen from the mission file; on the command line one of the working directory first.
std::filesystem::path camera_file(const TableReader& section, const std::string& camera,
                                  const mission::SensorContext& context) {
  if (mission::is_seen_from_file(camera) || camera.starts_with("/")) {
    std::filesystem::path on_command_line = mission::file_on_command_line(section, "camera", camera);
    if (!on_command_line.empty()) return on_command_line;
    return std::filesystem::absolute(context.mission.file).parent_path() / camera;
  }
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
  camera.settings.star_catalogue_file =
      mission::data_file(section, "star_catalogue_file", camera.settings.star_catalogue_file, context.mission);
  camera.observed = mission::read_other_spacecraft(section, context.spacecraft, context.spacecraft_names);
  camera.navigation = read_uses(section);
  camera.keypoint_exposure_s = read_keypoint_exposure(section, camera);
  camera.images =
      mission::read_cadence(section, "period_s", from_to(0.1, 3600.0), context.mission, context.mission.step);
  camera.readout = section.span("readout_s", 1.0, from_to(0.0, 3600.0), 2.0);
  if (const auto q = mission::read_quaternion(section, "q_camera_body")) camera.q_camera_body = *q;
  const auto position = section.three_numbers("position_body_m", from_to(-50.0, 50.0), {{0.0, 0.0, 0.0}});
  camera.position_body_m = {position[0], position[1], position[2]};
  section.finish();
  if (fsw::seconds(camera.readout) + camera.settings.exposure_s > fsw::seconds(camera.images.shortest_period()))
    section.refuse(section.has("readout_s") ? "readout_s" : "period_s",
                   "images that come faster than one is exposed and read",
                   "exposure_s and readout_s that fit into period_s");
  return sensor;
}

}  // namespace vbar::sensors
