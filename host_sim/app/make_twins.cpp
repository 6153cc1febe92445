#include "host_sim/app/make_twins.h"

#include <stdexcept>
#include <utility>

#include "host_sim/mission/body_file.h"
#include "host_sim/twins/camera/camera_sensor.h"
#include "host_sim/twins/camera/model/cad_objects.h"
#include "host_sim/twins/camera/scene.h"
#include "host_sim/twins/gnss/gnss_receiver.h"
#include "host_sim/twins/gnss_sensor.h"
#include "host_sim/twins/ideal_navigation.h"
#include "host_sim/twins/ideal_thruster.h"
#include "host_sim/twins/recorded_log.h"

namespace vbar::app {

namespace {

constexpr const char* kDigital = "digital";

std::unique_ptr<twins::PacketSource> make_navigation_source(const mission::Mission& mission,
                                                            const mission::Spacecraft& spacecraft) {
  const mission::NavigationSensor& sensor = *spacecraft.navigation;
  if (sensor.source == mission::NavigationSource::kRecorded) {
    const twins::RecordedLog::Selection selection{spacecraft.number, {fsw::packets::Apid::kIdealNavigation}};
    return std::make_unique<twins::RecordedLog>(sensor.log, selection);
  }
  twins::IdealNavigation::Settings settings;
  settings.servicer = spacecraft.name;
  settings.servicer_number = spacecraft.number;
  settings.target = sensor.target;
  settings.start = mission.start_time();
  settings.period = sensor.period;
  return std::make_unique<twins::IdealNavigation>(settings);
}

std::unique_ptr<twins::PacketSource> make_gnss_sensor(const mission::Mission& mission,
                                                      const mission::Spacecraft& spacecraft,
                                                      const mission::Spacecraft& servicer,
                                                      const std::shared_ptr<const twins::gnss::Constellation>& sky,
                                                      const std::filesystem::path& data_directory) {
  const twins::gnss::GnssReceiverSettings& settings = spacecraft.gnss->receiver;
  twins::GnssSensor::Settings sensor;
  sensor.spacecraft = spacecraft.name;
  sensor.flight_number = servicer.number;
  sensor.start = mission.start_time();
  sensor.period = fsw::nearest_duration(settings.output.period_s);
  std::unique_ptr<twins::gnss::Crosslink> crosslink;
  if (&spacecraft != &servicer)
    crosslink = std::make_unique<twins::gnss::Crosslink>(mission.crosslink, mission.seed, spacecraft.name);
  auto receiver =
      std::make_unique<twins::gnss::GnssReceiver>(settings, sky, data_directory, mission.seed, spacecraft.name);
  return std::make_unique<twins::GnssSensor>(sensor, std::move(receiver), std::move(crosslink));
}

twins::camera::ImageMaker::Settings image_settings(const mission::Mission& mission,
                                                   const mission::Spacecraft& spacecraft) {
  twins::camera::ImageMaker::Settings settings;
  settings.camera = spacecraft.camera->settings;
  settings.name = spacecraft.name + "/camera";
  settings.seed = mission.seed;
  settings.spacecraft = spacecraft.number;
  return settings;
}

twins::camera::Renderer make_scene_renderer(const mission::Mission& mission, const mission::Spacecraft& spacecraft,
                                            const std::filesystem::path& data_directory) {
  std::vector<std::string> models;
  for (const mission::Spacecraft& other : mission.spacecraft)
    if (!other.model.empty() && &other != &spacecraft) models.push_back(other.model);
  const auto scene = std::make_shared<twins::camera::SceneRenderer>(spacecraft.camera->settings, data_directory,
                                                                    twins::camera::cad_objects(data_directory, models),
                                                                    twins::camera::cad_covers(data_directory, models));
  return [scene](const twins::camera::Exposure& exposure, twins::camera::PhotonImage& image) {
    scene->render(exposure, image);
  };
}

std::unique_ptr<twins::PacketSource> make_camera_sensor(const mission::Mission& mission,
                                                        const mission::Spacecraft& servicer,
                                                        const std::filesystem::path& data_directory) {
  const mission::CameraSensor& camera = *servicer.camera;
  twins::camera::CameraSensor::Settings sensor;
  sensor.image = image_settings(mission, servicer);
  sensor.mount.spacecraft = servicer.name;
  sensor.mount.q_camera_body = camera.q_camera_body;
  sensor.mount.position_body = camera.position_body_m;
  for (const mission::Spacecraft& other : mission.spacecraft) {
    if (other.model.empty() || &other == &servicer) continue;
    fsw::Vector3 centre_of_mass = fsw::Vector3::Zero();
    if (const auto* tumble = other.attitude ? std::get_if<mission::Tumble>(&*other.attitude) : nullptr)
      centre_of_mass = mission::load_body(data_directory / "bodies" / (tumble->body + ".toml")).centre_of_mass_m;
    sensor.mount.models.push_back({other.name, other.model, centre_of_mass});
  }
  // The first image is taken one period after the first step, which tells the platform where to look.
  sensor.start = mission.start_time() + camera.period;
  sensor.period = camera.period;
  sensor.readout = camera.readout;
  return std::make_unique<twins::camera::CameraSensor>(sensor, make_scene_renderer(mission, servicer, data_directory));
}

}  // namespace

std::vector<Source> make_sources(const mission::Mission& mission, const mission::Spacecraft& servicer,
                                 const std::filesystem::path& data_directory) {
  std::vector<Source> sources;
  if (servicer.navigation) {
    sources.push_back({servicer.name + "/navigation", std::string(mission::name_of(servicer.navigation->source)),
                       make_navigation_source(mission, servicer)});
  }
  if (servicer.gnss) {
    const auto sky = std::make_shared<const twins::gnss::Constellation>(data_directory, mission.constellation,
                                                                        mission.start_time(), mission.seed);
    sources.push_back(
        {servicer.name + "/gnss", kDigital, make_gnss_sensor(mission, servicer, servicer, sky, data_directory)});
    if (const mission::Spacecraft* const partner = mission.find_spacecraft(servicer.gnss->partner))
      sources.push_back(
          {partner->name + "/gnss", kDigital, make_gnss_sensor(mission, *partner, servicer, sky, data_directory)});
  }
  if (servicer.camera)
    sources.push_back({servicer.name + "/camera", kDigital, make_camera_sensor(mission, servicer, data_directory)});
  return sources;
}

twins::camera::TileRestorer::MakeImage make_image_maker(const mission::Mission& mission,
                                                        const mission::Spacecraft& servicer,
                                                        const std::filesystem::path& data_directory) {
  if (!servicer.camera) {
    throw std::runtime_error("spacecraft \"" + servicer.name +
                             "\" has no digital camera that could make the images of the log again");
  }
  const auto maker = std::make_shared<twins::camera::ImageMaker>(
      image_settings(mission, servicer), make_scene_renderer(mission, servicer, data_directory));
  return [maker](const twins::camera::ImageRecipe& recipe) { return maker->packets_of(recipe.exposure); };
}

std::optional<double> gnss_static_floor_m(const mission::Mission& mission, const mission::Spacecraft& servicer) {
  if (!servicer.gnss || servicer.gnss->partner.empty()) return std::nullopt;
  const mission::Spacecraft& partner = *mission.find_spacecraft(servicer.gnss->partner);
  const twins::gnss::BodyFrameSettings& ours = servicer.gnss->receiver.body_frame;
  const twins::gnss::BodyFrameSettings& theirs = partner.gnss->receiver.body_frame;
  const auto our_errors = twins::gnss::draw_body_frame(ours, mission.seed, servicer.name);
  const auto their_errors = twins::gnss::draw_body_frame(theirs, mission.seed, partner.name);
  return twins::gnss::static_floor_m(ours, our_errors, theirs, their_errors).norm();
}

std::unique_ptr<twins::Actuator> make_thruster(const mission::Mission& mission, const mission::Spacecraft& spacecraft) {
  twins::IdealThruster::Settings settings;
  settings.spacecraft_number = spacecraft.number;
  settings.magnitude_error = spacecraft.thruster->magnitude_error;
  settings.pointing_error_rad = spacecraft.thruster->pointing_error_rad;
  return std::make_unique<twins::IdealThruster>(settings,
                                                engine::RandomStream(mission.seed, spacecraft.name + "/thruster"));
}

}  // namespace vbar::app
