#include "host_sim/sensors/camera/camera_kind.h"

#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "fsw/math/math.h"
#include "host_sim/sensors/camera/camera_report.h"
#include "host_sim/sensors/camera/make_camera.h"
#include "host_sim/sensors/sensor_kind.h"
#include "host_sim/twins/recorded_log.h"

namespace vbar::sensors {
namespace {

using mission::Mission;
using mission::Sensor;
using mission::Spacecraft;
using mission::TableReader;

/// Checks that the spacecraft can be seen, and that the mission states what navigation needs to know about it.
void check_target(const TableReader& section, const CameraSensor& camera, const Mission& mission) {
  const Spacecraft& target = *mission.find_spacecraft(camera.observed);
  if (target.model.empty() || !target.attitude)
    section.refuse(
        "target",
        "the spacecraft \"" + target.name + "\" without " + (target.model.empty() ? "a model" : "an attitude"),
        "a spacecraft with a model and an attitude, so that it can be seen");
  if (camera.has_use(CameraSensor::kKeypoints) && !std::holds_alternative<mission::Tumble>(*target.attitude))
    section.refuse("target", "the spacecraft \"" + target.name + "\", which does not tumble",
                   "with navigation = \"pose\": a spacecraft that tumbles, by laws that are known on board");
}

/// Checks that the flight software has a network for the model. The weights of a network are part of the flight
/// software: vbar's own are those of Tango, a library vbar_gnc_<model> of boards/targets has those of the model of its
/// name. The networks of other libraries and images are not known here.
void check_network(const TableReader& section, const mission::FlightComputer& computer, const std::string& model) {
  constexpr std::string_view kOfOtherTargets = "vbar_gnc_";
  const bool is_own =
      computer.library.empty() && computer.image.empty() && computer.target != mission::FlightTarget::kBoard;
  std::string known;
  if (is_own) known = "tango";
  if (computer.library.starts_with(kOfOtherTargets)) known = computer.library.substr(kOfOtherTargets.size());
  if (known.empty() || known == model) return;
  section.refuse(
      "target",
      fmt::format("a spacecraft with the model \"{}\", which the network of this flight software does not know", model),
      fmt::format("the model \"{}\", or flight_computer.library = \"vbar_gnc_{}\" or an image with the weights of "
                  "data/networks/{}_keypoints.bin",
                  known, model, model));
}

/// A camera navigates with the flight software and the receiver beside it, to something that it can see.
void check(const TableReader& section, const Sensor& sensor, const Spacecraft& servicer, const Mission& mission) {
  const auto& camera = settings_of<CameraSensor>(sensor);
  if (!servicer.attitude) section.refuse("", "a camera without an attitude", "an attitude: a camera looks somewhere");
  check_target(section, camera, mission);
  if (!camera.is_used()) return;
  const testbeds::TestbedKind* const testbed = testbeds::find_testbed(camera.source);
  if (camera.changes_use() && testbed != nullptr && !testbed->shows_commanded_exposures)
    section.refuse("navigation",
                   "two uses of a camera of the testbed \"" + camera.source + "\", whose exposure is fixed",
                   "one of \"angles_only\" and \"pose\"");
  if (!servicer.flight_computer)
    section.refuse("", "a camera without a flight computer", "a camera of a spacecraft that flies software");
  if (camera.has_use(CameraSensor::kKeypoints))
    check_network(section, *servicer.flight_computer, mission.find_spacecraft(camera.observed)->model);
  using Use = vbar::navigation_configuration;
  const Sensor* receiver = nullptr;
  std::size_t cameras = 0;
  for (const Sensor& other : servicer.sensors) {
    if ((other.settings->navigation & Use::kUseOwnGnss) != 0) receiver = &other;
    if (other.kind != sensor.kind || other.settings->navigation == 0) continue;
    ++cameras;
    if (other.settings->observed != camera.observed)
      section.refuse("target",
                     "the spacecraft \"" + camera.observed + "\" beside a camera that navigates to \"" +
                         other.settings->observed + "\"",
                     "one target of all cameras whose images navigation uses");
    if (&other != &sensor && (other.settings->navigation & camera.navigation & Use::kUseBearings) != 0)
      section.refuse("navigation", "a second camera whose bearings navigation uses",
                     "\"angles_only\" for one camera of a spacecraft; \"pose\" or \"none\" for the others");
  }
  if (cameras > fsw::packets::kCameras)
    section.refuse("navigation", std::to_string(cameras) + " cameras whose images navigation uses",
                   "\"none\" for all cameras of a spacecraft but " + std::to_string(fsw::packets::kCameras));
  if (receiver == nullptr)
    section.refuse("", "a camera without a GNSS receiver", "a GNSS receiver too: it gives the spacecraft's own orbit");
  const std::string& partner = receiver->settings->observed;
  if (!partner.empty() && partner != camera.observed)
    section.refuse(
        "target",
        "the spacecraft \"" + camera.observed + "\" beside a GNSS receiver with the partner \"" + partner + "\"",
        "the partner, or a GNSS receiver without a partner: one target of all sensors");
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
  if (const testbeds::TestbedKind* const testbed = testbeds::find_testbed(own.settings->source))
    return make_of_testbed(*testbed, own, context);
  return make_digital_camera(context.mission, context.servicer, own, context.data_directory);
}

void add_sources(const Sensor& sensor, const MakeContext& context, std::vector<twins::NamedSource>& sources) {
  const auto& camera = settings_of<CameraSensor>(sensor);
  const std::string name = source_name(context.servicer, sensor);
  if (camera.source == "recorded") {
    twins::RecordedLog::Selection selection{context.servicer.number, {fsw::packets::Apid::kImageTile}};
    if (camera.is_used()) selection.unit = camera_unit(sensor, context.servicer);
    const auto make_tiles = [&](twins::ImagesOfLog&& images) {
      return make_recorded_tile_source(
          [&mission = context.mission, &servicer = context.servicer, &sensor, data = context.data_directory] {
            return make_digital_camera(mission, servicer, sensor, data);
          },
          std::move(images));
    };
    sources.push_back({name, camera.source, std::make_unique<twins::RecordedLog>(camera.log, selection, make_tiles)});
    return;
  }
  if (auto packets = packets_of_testbed(sensor, kCamera, context, context.servicer, {fsw::packets::Apid::kImageTile},
                                        camera_unit(sensor, context.servicer))) {
    sources.push_back({name, camera.source, std::move(packets)});
    return;
  }
  sources.push_back({name, camera.source,
                     make_camera(context.mission, context.servicer, sensor, context.data_directory,
                                 make_image_taker(sensor, context))});
}

std::string_view name_of_navigation(const Spacecraft& servicer) {
  const bool has_bearings = first_camera_for(CameraSensor::kBearings, servicer) != nullptr;
  const bool has_pose = first_camera_for(CameraSensor::kKeypoints, servicer) != nullptr;
  return has_bearings && has_pose ? "angles_only+pose" : has_pose ? "pose" : "angles_only";
}

void add_facts(const Sensor& sensor, const Mission& /*mission*/, const Spacecraft& servicer, report::RunFacts& facts) {
  const bool is_used = settings_of<CameraSensor>(sensor).is_used();
  if (is_used || facts.camera.empty()) facts.camera = sensor.settings->source;
  if (is_used) facts.navigation = name_of_navigation(servicer);
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

const SensorKind kCamera{
    {"camera", "", read_camera, read_camera_shared, check},
    {fsw::packets::Apid::kImageTile, std::nullopt, camera_unit},
    add_camera_telecommands,
    add_sources,
    add_facts,
    evaluate_camera,
    true,
    {tables, summarise_images, sections, kMessagesInTables, camera_paper_columns, image_consistency},
    make_camera_tile_source};

const CameraSensor* navigation_camera(const Spacecraft& carrier, std::uint8_t unit) {
  for (const Sensor& sensor : carrier.sensors)
    if (const auto* const camera = dynamic_cast<const CameraSensor*>(sensor.settings.get());
        camera != nullptr && camera->is_used() && camera_unit(sensor, carrier) == unit)
      return camera;
  return nullptr;
}

const CameraSensor* first_camera_for(std::int32_t use, const Spacecraft& carrier) {
  for (const Sensor& sensor : carrier.sensors)
    if (const auto* const camera = dynamic_cast<const CameraSensor*>(sensor.settings.get());
        camera != nullptr && camera->has_use(use))
      return camera;
  return nullptr;
}

std::uint8_t camera_unit(const Sensor& sensor, const Spacecraft& carrier) {
  const auto is_used = [](const Sensor& camera) { return settings_of<CameraSensor>(camera).is_used(); };
  std::uint8_t unit = is_used(sensor) ? 0 : static_cast<std::uint8_t>(fsw::packets::kCameras);
  for (const Sensor& other : carrier.sensors) {
    if (other.name == sensor.name) break;
    if (other.kind == sensor.kind && is_used(other) == is_used(sensor)) ++unit;
  }
  return unit;
}

}  // namespace vbar::sensors
