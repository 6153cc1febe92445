#include "host_sim/sensors/camera/make_camera.h"

#include <algorithm>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "host_sim/mission/body_file.h"
#include "host_sim/sensors/installed_testbeds.h"
#include "host_sim/twins/camera/logged_image.h"
#include "host_sim/twins/camera/model/cad_objects.h"
#include "host_sim/twins/camera/scene.h"

namespace vbar::sensors {

KnownCamera known_camera(const CameraSensor& camera, const mission::Mission& mission,
                         const std::filesystem::path& data_directory) {
  KnownCamera known{camera, std::nullopt};
  const testbeds::TestbedKind* const testbed = testbeds::find_testbed(camera.source);
  if (testbed == nullptr || testbed->calibrated_camera == nullptr) return known;
  const auto of_mission = std::ranges::find(mission.testbeds, testbed->name, &mission::Testbed::name);
  if (of_mission == mission.testbeds.end())
    throw std::logic_error("the mission has no [testbed." + std::string(testbed->name) + "]");
  const auto calibrated = testbed->calibrated_camera(*of_mission->settings, mission, data_directory, camera.settings);
  known.sensor.settings = calibrated.settings;
  known.centroid_floor_px = calibrated.centroid_floor_px;
  return known;
}

namespace {

using mission::Mission;
using mission::Sensor;
using mission::Spacecraft;

twins::camera::ImageMaker::Settings image_settings(const Mission& mission, const Spacecraft& spacecraft,
                                                   const Sensor& sensor) {
  twins::camera::ImageMaker::Settings settings;
  settings.camera = settings_of<CameraSensor>(sensor).settings;
  settings.name = spacecraft.name + "/" + sensor.name;
  settings.seed = mission.seed;
  settings.spacecraft = spacecraft.number;
  settings.unit = camera_unit(sensor, spacecraft);
  return settings;
}

twins::camera::Renderer make_scene_renderer(const Mission& mission, const Spacecraft& spacecraft,
                                            const twins::camera::CameraSettings& camera,
                                            const std::filesystem::path& data_directory) {
  const std::shared_ptr<twins::camera::SceneRenderer> scene = make_scene(mission, spacecraft, camera, data_directory);
  return [scene](const twins::camera::Exposure& exposure, twins::camera::PhotonImage& image) {
    scene->render(exposure, image);
  };
}

/// The camera that could have made an image of a log by rendering.
const Sensor& digital_camera(const Spacecraft& servicer, std::uint8_t unit) {
  for (const Sensor& sensor : servicer.sensors) {
    const auto* const camera = dynamic_cast<const CameraSensor*>(sensor.settings.get());
    if (camera == nullptr || camera_unit(sensor, servicer) != unit) continue;
    if (camera->source == "digital" || camera->source == "recorded") return sensor;
  }
  throw std::runtime_error("spacecraft \"" + servicer.name + "\" has no digital camera of unit " +
                           std::to_string(unit) + " that could render the images of the log again");
}

}  // namespace

std::unique_ptr<twins::camera::SceneRenderer> make_scene(const Mission& mission, const Spacecraft& spacecraft,
                                                         const twins::camera::CameraSettings& camera,
                                                         const std::filesystem::path& data_directory,
                                                         std::shared_ptr<const twins::camera::Projection> projection) {
  std::vector<std::string> models;
  for (const Spacecraft& other : mission.spacecraft)
    if (!other.model.empty() && &other != &spacecraft) models.push_back(other.model);
  const auto sources = mission::cad_sources_of(data_directory, models);
  return std::make_unique<twins::camera::SceneRenderer>(camera, data_directory, twins::camera::cad_objects(sources),
                                                        twins::camera::cad_covers(sources), std::move(projection));
}

std::unique_ptr<twins::camera::ImageMaker> make_digital_camera(const Mission& mission, const Spacecraft& servicer,
                                                               const Sensor& sensor,
                                                               const std::filesystem::path& data_directory) {
  const auto& camera = settings_of<CameraSensor>(sensor);
  return std::make_unique<twins::camera::ImageMaker>(
      image_settings(mission, servicer, sensor),
      make_scene_renderer(mission, servicer, camera.settings, data_directory));
}

twins::camera::CameraMount mount_of(const Mission& mission, const Spacecraft& servicer, const CameraSensor& camera,
                                    const std::filesystem::path& data_directory) {
  twins::camera::CameraMount mount;
  mount.spacecraft = servicer.name;
  mount.q_camera_body = camera.q_camera_body;
  mount.position_body = camera.position_body_m;
  for (const Spacecraft& other : mission.spacecraft) {
    if (other.model.empty() || &other == &servicer) continue;
    fsw::Vector3 centre_of_mass = fsw::Vector3::Zero();
    if (const auto* tumble = other.attitude ? std::get_if<mission::Tumble>(&*other.attitude) : nullptr)
      centre_of_mass = mission::load_body(mission::body_file_of(data_directory, tumble->body)).centre_of_mass_m;
    mount.models.push_back({other.name, other.model, centre_of_mass});
  }
  return mount;
}

std::unique_ptr<twins::PacketSource> make_camera(const Mission& mission, const Spacecraft& servicer,
                                                 const Sensor& sensor, const std::filesystem::path& data_directory,
                                                 std::unique_ptr<twins::camera::ImageTaker> taker) {
  const auto& camera = settings_of<CameraSensor>(sensor);
  twins::camera::CameraSensor::Settings settings;
  settings.image = image_settings(mission, servicer, sensor);
  settings.mount = mount_of(mission, servicer, camera, data_directory);
  // The first image is taken one period after the first step, which commands the pointing of the platform.
  settings.images = camera.images;
  settings.until = camera.images_until;
  settings.readout = camera.readout;
  if (camera.changes_use()) settings.first_exposure_s = camera.settings.exposure_s;
  settings.sends_packets = camera.is_used();
  return std::make_unique<twins::camera::CameraSensor>(settings, std::move(taker));
}

std::unique_ptr<twins::TileSource> make_recorded_tile_source(
    const std::function<std::unique_ptr<twins::camera::ImageMaker>()>& make_digital, twins::ImagesOfLog&& images) {
  const auto maker = std::make_shared<std::unique_ptr<twins::camera::ImageMaker>>();
  const auto make_image = [maker, make_digital](const twins::camera::ImageRecipe& recipe) {
    if (!*maker) *maker = make_digital();
    return (*maker)->packets_of(recipe.exposure);
  };
  return std::make_unique<twins::camera::TileRestorer>(std::move(images), make_image);
}

std::unique_ptr<twins::TileSource> make_camera_tile_source(const RestoreContext& context, twins::ImagesOfLog&& images) {
  // By unit; made when the first image of its camera is.
  const auto makers = std::make_shared<std::map<std::uint8_t, std::unique_ptr<twins::camera::ImageMaker>>>();
  const auto make_image = [makers, context](const twins::camera::ImageRecipe& recipe) {
    auto& maker = (*makers)[recipe.unit];
    if (!maker)
      maker = make_digital_camera(context.mission, context.servicer, digital_camera(context.servicer, recipe.unit),
                                  context.data_directory);
    return maker->packets_of(recipe.exposure);
  };
  return std::make_unique<twins::camera::TileRestorer>(std::move(images), make_image);
}

}  // namespace vbar::sensors
