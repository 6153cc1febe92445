#include "host_sim/sensors/camera/camera_kind.h"

#include <map>
#include <stdexcept>
#include <string>
#include <utility>

#include "fsw/math/math.h"
#include "host_sim/mission/body_file.h"
#include "host_sim/sensors/camera/camera_report.h"
#include "host_sim/twins/camera/camera_sensor.h"
#include "host_sim/twins/camera/model/cad_objects.h"
#include "host_sim/twins/camera/scene.h"
#include "host_sim/twins/recorded_log.h"

namespace vbar::sensors {
namespace {

using mission::Mission;
using mission::Sensor;
using mission::Spacecraft;
using mission::TableReader;

/// The spacecraft can be seen, and navigation has what it needs to know of it.
void check_target(const TableReader& section, const CameraSensor& camera, const Mission& mission) {
  const Spacecraft& target = *mission.find_spacecraft(camera.observed);
  if (target.model.empty() || !target.attitude)
    section.refuse(
        "target",
        "the spacecraft \"" + target.name + "\" without " + (target.model.empty() ? "a model" : "an attitude"),
        "a spacecraft with a model and an attitude, so that it can be seen");
  if (camera.use == CameraNavigation::kPose && !std::holds_alternative<mission::Tumble>(*target.attitude))
    section.refuse("target", "the spacecraft \"" + target.name + "\", which does not tumble",
                   "with navigation = \"pose\": a spacecraft that tumbles, by laws that are known on board");
}

/// A camera navigates with the flight software and the receiver beside it, to something that it can see.
void check(const TableReader& section, const Sensor& sensor, const Spacecraft& servicer, const Mission& mission) {
  const auto& camera = settings_of<CameraSensor>(sensor);
  if (!servicer.attitude) section.refuse("", "a camera without an attitude", "an attitude: a camera looks somewhere");
  check_target(section, camera, mission);
  if (camera.use == CameraNavigation::kNone) return;
  if (!servicer.flight_computer)
    section.refuse("", "a camera without a flight computer", "a camera of a spacecraft that flies software");
  const Sensor* receiver = nullptr;
  for (const Sensor& other : servicer.sensors) {
    if (other.settings->navigation == vbar::navigation_configuration::kSourceGnss) receiver = &other;
    if (&other != &sensor && other.settings->navigation > vbar::navigation_configuration::kSourceGnss)
      section.refuse("navigation", "a second camera whose images navigation uses",
                     "\"none\" for all cameras of a spacecraft but one");
  }
  if (receiver == nullptr)
    section.refuse("", "a camera without a GNSS receiver", "a GNSS receiver too: it gives the spacecraft's own orbit");
  if (!receiver->settings->observed.empty())
    section.refuse("", "a camera beside a GNSS receiver with the partner \"" + receiver->settings->observed + "\"",
                   "a GNSS receiver without a partner: the target does not cooperate");
}

/// The unit in packet headers. The flight software takes the images of unit 0: those of the camera that navigation
/// uses.
std::uint8_t camera_unit(const Sensor& sensor, const Spacecraft& carrier) {
  std::uint8_t unit = navigation_camera(carrier) != nullptr ? 1 : 0;
  if (sensor.settings->navigation >= 0) return 0;
  for (const Sensor& other : carrier.sensors) {
    if (other.name == sensor.name) break;
    if (other.kind == sensor.kind && other.settings->navigation < 0) ++unit;
  }
  return unit;
}

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

/// Null projection: the lens of the camera.
std::unique_ptr<twins::camera::SceneRenderer> make_scene(
    const Mission& mission, const Spacecraft& spacecraft, const twins::camera::CameraSettings& camera,
    const std::filesystem::path& data_directory,
    std::shared_ptr<const twins::camera::Projection> projection = nullptr) {
  std::vector<std::string> models;
  for (const Spacecraft& other : mission.spacecraft)
    if (!other.model.empty() && &other != &spacecraft) models.push_back(other.model);
  return std::make_unique<twins::camera::SceneRenderer>(
      camera, data_directory, twins::camera::cad_objects(data_directory, models),
      twins::camera::cad_covers(data_directory, models), std::move(projection));
}

twins::camera::Renderer make_scene_renderer(const Mission& mission, const Spacecraft& spacecraft,
                                            const twins::camera::CameraSettings& camera,
                                            const std::filesystem::path& data_directory) {
  const std::shared_ptr<twins::camera::SceneRenderer> scene = make_scene(mission, spacecraft, camera, data_directory);
  return [scene](const twins::camera::Exposure& exposure, twins::camera::PhotonImage& image) {
    scene->render(exposure, image);
  };
}

std::unique_ptr<twins::camera::ImageTaker> make_of_testbed(const testbeds::TestbedKind& testbed, const Sensor& own,
                                                           const MakeContext& context) {
  if (context.outlook == nullptr) throw std::logic_error("a testbed requires the truth of the run");
  const auto run = context.testbeds.run_of(testbed, {context.mission, context.data_directory, *context.outlook});
  testbeds::CameraPlan plan;
  plan.name = source_name(context.servicer, own);
  plan.settings = settings_of<CameraSensor>(own).settings;
  plan.make_scene = [&mission = context.mission, &servicer = context.servicer, data = context.data_directory](
                        const twins::camera::CameraSettings& settings,
                        std::shared_ptr<const twins::camera::Projection> projection) {
    return make_scene(mission, servicer, settings, data, std::move(projection));
  };
  auto camera = run->make_camera(plan);
  if (!camera) throw std::runtime_error("testbed \"" + std::string(testbed.name) + "\" has no camera");
  return camera;
}

std::unique_ptr<twins::camera::ImageTaker> make_image_taker(const Sensor& own, const MakeContext& context) {
  const auto& camera = settings_of<CameraSensor>(own);
  if (const testbeds::TestbedKind* const testbed = testbeds::find_testbed(camera.source))
    return make_of_testbed(*testbed, own, context);
  return std::make_unique<twins::camera::ImageMaker>(
      image_settings(context.mission, context.servicer, own),
      make_scene_renderer(context.mission, context.servicer, camera.settings, context.data_directory));
}

std::unique_ptr<twins::PacketSource> make_camera(const Sensor& own, const MakeContext& context) {
  const Mission& mission = context.mission;
  const Spacecraft& servicer = context.servicer;
  const auto& camera = settings_of<CameraSensor>(own);
  twins::camera::CameraSensor::Settings sensor;
  sensor.image = image_settings(mission, servicer, own);
  sensor.mount.spacecraft = servicer.name;
  sensor.mount.q_camera_body = camera.q_camera_body;
  sensor.mount.position_body = camera.position_body_m;
  for (const Spacecraft& other : mission.spacecraft) {
    if (other.model.empty() || &other == &servicer) continue;
    fsw::Vector3 centre_of_mass = fsw::Vector3::Zero();
    if (const auto* tumble = other.attitude ? std::get_if<mission::Tumble>(&*other.attitude) : nullptr)
      centre_of_mass =
          mission::load_body(context.data_directory / "bodies" / (tumble->body + ".toml")).centre_of_mass_m;
    sensor.mount.models.push_back({other.name, other.model, centre_of_mass});
  }
  // The first image is taken one period after the first step, which tells the platform where to look.
  sensor.start = mission.start_time() + camera.period;
  sensor.period = camera.period;
  sensor.readout = camera.readout;
  return std::make_unique<twins::camera::CameraSensor>(sensor, make_image_taker(own, context));
}

/// Images that are recorded but not sent to the flight software.
class RecordedOnly final : public twins::PacketSource {
 public:
  explicit RecordedOnly(std::unique_ptr<twins::PacketSource> camera) : camera_(std::move(camera)) {}

  [[nodiscard]] std::optional<fsw::GpsTime> next_epoch(fsw::GpsTime from) const override {
    return camera_->next_epoch(from);
  }

  void start(fsw::GpsTime first_epoch) override { camera_->start(first_epoch); }
  void stop(twins::StopReason reason) override { camera_->stop(reason); }
  [[nodiscard]] std::vector<twins::Note> statistics() const override { return camera_->statistics(); }

  twins::Measurement measure(const twins::TruthSnapshot& truth) override {
    twins::Measurement measurement = camera_->measure(truth);
    measurement.packets.clear();
    measurement.pending = {};
    return measurement;
  }

 private:
  std::unique_ptr<twins::PacketSource> camera_;
};

twins::camera::TileRestorer::MakeImage image_maker_of(const Mission& mission, const Spacecraft& servicer,
                                                      const Sensor& sensor,
                                                      const std::filesystem::path& data_directory) {
  const auto maker = std::make_shared<twins::camera::ImageMaker>(
      image_settings(mission, servicer, sensor),
      make_scene_renderer(mission, servicer, settings_of<CameraSensor>(sensor).settings, data_directory));
  return [maker](const twins::camera::ImageRecipe& recipe) { return maker->packets_of(recipe.exposure); };
}

/// Renders the images of a log that keeps their recipes only.
twins::TileSource tile_source(std::span<const std::vector<std::uint8_t>> recipes,
                              twins::camera::TileRestorer::MakeImage make_image) {
  const auto restorer = std::make_shared<twins::camera::TileRestorer>(recipes, std::move(make_image));
  twins::TileSource source;
  source.packets_of = [restorer](const twins::TileRun& run) { return restorer->packets_of(run); };
  for (const std::vector<std::uint8_t>& recipe : recipes)
    if (const auto image = twins::camera::recipe_of(recipe)) source.recipes[image->exposure.time] = recipe;
  return source;
}

void add_sources(const Sensor& sensor, const MakeContext& context, std::vector<twins::NamedSource>& sources) {
  const auto& camera = settings_of<CameraSensor>(sensor);
  const std::string name = source_name(context.servicer, sensor);
  if (camera.source == "recorded") {
    const twins::RecordedLog::Selection selection{context.servicer.number, {fsw::packets::Apid::kImageTile}};
    const auto make_tiles = [&](std::span<const std::vector<std::uint8_t>> recipes) {
      return tile_source(recipes, image_maker_of(context.mission, context.servicer, sensor, context.data_directory));
    };
    sources.push_back({name, camera.source, std::make_unique<twins::RecordedLog>(camera.log, selection, make_tiles)});
    return;
  }
  auto images = make_camera(sensor, context);
  if (camera.use == CameraNavigation::kNone) images = std::make_unique<RecordedOnly>(std::move(images));
  sources.push_back({name, camera.source, std::move(images)});
}

void add_facts(const Sensor& sensor, const Mission& /*mission*/, const Spacecraft& /*servicer*/,
               report::RunFacts& facts) {
  const CameraNavigation use = settings_of<CameraSensor>(sensor).use;
  if (use != CameraNavigation::kNone || facts.camera.empty()) facts.camera = sensor.settings->source;
  if (use != CameraNavigation::kNone) facts.navigation = use == CameraNavigation::kPose ? "pose" : "angles_only";
}

using fsw::math::kArcsecond;
constexpr report::OldColumn kOldImageColumns[] = {
    {"attitude_sigma_arcsec", "attitude_sigma_rad", kArcsecond},
    {"bearing_sigma_arcsec", "bearing_sigma_rad", kArcsecond},
    {"prefit_*_arcsec", "prefit_*_rad", kArcsecond},
    {"postfit_*_arcsec", "postfit_*_rad", kArcsecond},
    {"used", "fate", 1.0, 1},  // 0 was refused or none
    {"covariance_a_roe_m2_*", "covariance_a_roe_*_m2"},
};
constexpr report::OldColumn kOldPoseColumns[] = {{"covariance_a_roe_m2_*", "covariance_a_roe_*_m2"}};

constexpr fsw::packets::Apid kMessagesInTables[] = {
    fsw::packets::Apid::kTelemetryImage, fsw::packets::Apid::kTelemetryObjects, fsw::packets::Apid::kTelemetryPose};

std::vector<report::TableKind> tables() {
  using report::table_of_extension;
  using enum report::Rows;
  using enum report::Presence;
  return {table_of_extension<ImageRow>("images.csv", kGrow, kIfNotEmpty, kOldImageColumns),
          table_of_extension<ObjectRow>("objects.csv"),
          table_of_extension<PoseRow>("poses.csv", kGrow, kIfNotEmpty, kOldPoseColumns),
          table_of_extension<KeypointRow>("keypoints.csv")};
}

std::vector<report::Section> sections(const report::RunRecord& record) {
  return {angles_only_section(record), pose_section(record)};
}

}  // namespace

const SensorKind kCamera{{"camera", "", read_camera, read_camera_shared, check},
                         add_camera_telecommands,
                         add_sources,
                         add_facts,
                         evaluate_camera,
                         {tables, summarise_images, sections, kMessagesInTables}};

const CameraSensor* navigation_camera(const Spacecraft& carrier) {
  for (const Sensor& sensor : carrier.sensors)
    if (const auto* const camera = dynamic_cast<const CameraSensor*>(sensor.settings.get());
        camera != nullptr && camera->use != CameraNavigation::kNone)
      return camera;
  return nullptr;
}

twins::camera::TileRestorer::MakeImage make_image_maker(const Mission& mission, const Spacecraft& servicer,
                                                        const std::filesystem::path& data_directory) {
  // By unit; made when the first image of its camera is, since a renderer is large.
  const auto makers = std::make_shared<std::map<std::uint8_t, twins::camera::TileRestorer::MakeImage>>();
  return [makers, &mission, &servicer, data_directory](const twins::camera::ImageRecipe& recipe) {
    for (const Sensor& sensor : servicer.sensors) {
      const auto* const camera = dynamic_cast<const CameraSensor*>(sensor.settings.get());
      if (camera == nullptr || camera->source != "digital" || camera_unit(sensor, servicer) != recipe.unit) continue;
      auto& maker = (*makers)[recipe.unit];
      if (!maker) maker = image_maker_of(mission, servicer, sensor, data_directory);
      return maker(recipe);
    }
    throw std::runtime_error("spacecraft \"" + servicer.name + "\" has no digital camera of unit " +
                             std::to_string(recipe.unit) + " that could render the images of the log again");
  };
}

}  // namespace vbar::sensors
