#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "fsw/math/math.h"
#include "host_sim/mission/body_file.h"
#include "host_sim/mission/data_file.h"
#include "host_sim/mission/mission.h"
#include "host_sim/mission/name_search.h"
#include "host_sim/mission/read_attitude.h"
#include "host_sim/mission/read_sections.h"
#include "host_sim/mission/sensor_reader.h"
#include "host_sim/sensors/camera/camera_kind.h"
#include "host_sim/sensors/camera/make_camera.h"
#include "host_sim/sensors/settings/camera_file.h"

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
  camera.images_until =
      context.mission.epoch +
      section.span("until_h", mission::kHour_s, from_to(0.0, mission::kLongestMission_h), mission::kLongestMission_h);
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

namespace {

using mission::above_to;
using mission::Range;

constexpr double kArcsecond = fsw::math::kDegree / 3600.0;

/// initial_sigma_a_da_m and so on: 1 sigma of the mean ROE of an unknown formation, times the reference semi-major
/// axis.
fsw::Vector6 read_initial_sigmas(const TableReader& section) {
  const Range sigma_m = above_to(0.0, 1e5);
  const double a = section.number("initial_sigma_a_da_m", sigma_m, 1.0);
  const double lambda = section.number("initial_sigma_a_dlambda_m", sigma_m, 100.0);
  const double e = section.number("initial_sigma_a_de_m", sigma_m, 5.0);
  const double i = section.number("initial_sigma_a_di_m", sigma_m, 5.0);
  return {a, lambda, e, e, i, i};
}

void read_angles_only(const TableReader& section, CameraShared& shared) {
  vbar::angles_only_configuration& navigation = shared.angles_only;
  navigation.detection_sigmas = section.number("detection_threshold_sigma", from_to(2.0, 100.0), 5.0);
  navigation.centroid_floor_px = section.number("centroid_floor_px", above_to(0.0, 10.0), 0.05);
  navigation.pointing_tolerance =
      kArcsecond * section.number("pointing_tolerance_arcsec", above_to(0.0, 36000.0), 600.0);
  navigation.brightness_offset_m = section.number("brightness_offset_m", from_to(0.0, 100.0), 0.15);
  navigation.centroid_noise_m = section.number("centroid_noise_m", from_to(0.0, 100.0), 0.08);
  navigation.bearing_bias = kArcsecond * section.number("bearing_bias_arcsec", above_to(0.0, 3600.0), 3.0);
  navigation.batch_images = static_cast<std::int32_t>(section.integer("batch_images", 3, 1000, 30));
  section.finish();
}

void read_pose(const TableReader& section, vbar::pose_configuration& navigation) {
  navigation.keypoint_sigma_scale = section.number("keypoint_sigma_scale", above_to(0.0, 100.0), 1.0);
  navigation.keypoint_floor_px = section.number("keypoint_floor_px", from_to(0.0, 100.0), 0.2);
  std::ranges::copy(read_initial_sigmas(section), navigation.start_sigma_a_roe_m);
  navigation.start_images = static_cast<std::int32_t>(section.integer("initial_poses", 1, 12, 3));
  section.finish();
}

}  // namespace

std::shared_ptr<const mission::SharedSettings> read_camera_shared(const TableReader& document,
                                                                  const mission::Mission& /*mission*/) {
  auto shared = std::make_shared<CameraShared>();
  const TableReader navigation = document.table("navigation");
  read_angles_only(navigation.table("angles_only"), *shared);
  read_pose(navigation.table("pose"), shared->pose);
  return shared;
}

namespace {

using mission::Mission;
using mission::Spacecraft;

/// Level and noise of a pixel without light.
void set_dark_levels(const twins::camera::CameraSettings& camera, vbar::camera_configuration& configuration) {
  const twins::camera::DetectorSettings& detector = camera.detector;
  const double dark_electrons = detector.dark_electrons_per_s * camera.exposure_s;
  configuration.dark_level_dn = detector.offset_dn + detector.gain_dn_per_electron * dark_electrons;
  constexpr double kRounding = 1.0 / 12.0;  // variance, DN^2
  const double read_dn = detector.gain_dn_per_electron * detector.read_noise_electrons;
  configuration.noise_dn = std::sqrt(
      read_dn * read_dn + detector.gain_dn_per_electron * detector.gain_dn_per_electron * dark_electrons + kRounding);
}

}  // namespace

vbar::camera_configuration camera_configuration_of(const CameraSensor& camera) {
  const twins::camera::CameraSettings& settings = camera.settings;
  const twins::camera::DetectorSettings& detector = settings.detector;
  vbar::camera_configuration configuration{};
  configuration.width = static_cast<std::int16_t>(settings.region.width);
  configuration.height = static_cast<std::int16_t>(settings.region.height);
  configuration.origin_x = static_cast<std::int16_t>(settings.region.x);
  configuration.origin_y = static_cast<std::int16_t>(settings.region.y);
  configuration.bits = static_cast<std::int8_t>(detector.bits);
  std::ranges::fill(configuration.focal_length_px, settings.focal_length_px());
  std::ranges::copy(settings.optics.principal_point_px, configuration.principal_point_px);
  std::ranges::copy(settings.optics.distortion, configuration.distortion);
  configuration.point_spread_sigma_px = settings.optics.point_spread_sigma_px;
  configuration.zero_magnitude_dn = settings.zero_magnitude_photons * settings.exposure_s *
                                    settings.electrons_per_photon_m2() * detector.gain_dn_per_electron;
  // A full pixel reads so much less a few sigma of noise; the converter's end comes first if the gain is high.
  constexpr double kFull = 0.99;
  const double full_dn = detector.offset_dn + kFull * detector.gain_dn_per_electron * detector.full_well_electrons;
  configuration.saturation_dn = std::min(full_dn, (1 << detector.bits) - 1.0);
  configuration.gain_dn_per_electron = detector.gain_dn_per_electron;
  set_dark_levels(settings, configuration);
  const Eigen::Quaterniond& q = camera.q_camera_body;
  std::ranges::copy(std::array{q.w(), q.x(), q.y(), q.z()}, configuration.q_camera_body);
  std::ranges::copy(camera.position_body_m, configuration.position_body_m);
  return configuration;
}

vbar::target_model target_model_of(const Mission& mission, const CameraSensor& sensor,
                                   const std::filesystem::path& data_directory) {
  vbar::target_model configuration{};
  configuration.angular_acceleration_psd = mission.navigation.angular_acceleration_psd;
  const Spacecraft& target = *mission.find_spacecraft(sensor.observed);
  const mission::Tumble& tumble = std::get<mission::Tumble>(*target.attitude);  // the loader sees to it
  const truth::Body body = mission::load_body(mission::body_file_of(data_directory, tumble.body));
  constexpr std::size_t kKeypoints = sizeof configuration.keypoints_body_m / (3 * sizeof(double));
  const auto keypoints_m = mission::load_keypoints(mission::body_file_of(data_directory, target.model), kKeypoints);
  for (std::size_t k = 0; k < kKeypoints; ++k) {
    const fsw::Vector3 from_centre_of_mass = keypoints_m[k] - body.centre_of_mass_m;
    std::ranges::copy(from_centre_of_mass, configuration.keypoints_body_m + 3 * k);
  }
  const fsw::Matrix3 I = tumble.inertia_kgm2.value_or(body.inertia_kgm2);
  std::ranges::copy(std::array{I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2)}, configuration.inertia_kgm2);
  return configuration;
}

void add_camera_telecommands(const mission::Sensor& sensor, const TelecommandContext& context,
                             Telecommands& telecommands) {
  const auto& own = settings_of<CameraSensor>(sensor);
  if (!own.is_used()) return;
  const std::uint8_t unit = camera_unit(sensor, context.servicer);
  const KnownCamera known = known_camera(own, context.mission, context.data_directory);
  const CameraSensor& camera = known.sensor;
  const auto& shared = mission::shared_settings<CameraShared>(context.mission);
  telecommands.add(camera_configuration_of(camera), unit);
  if (camera.has_use(CameraSensor::kKeypoints)) {
    auto configuration = shared.pose;
    configuration.exposure_s = camera.keypoint_exposure_s;
    telecommands.add(configuration, unit);
    // Once, whatever the number of cameras.
    if (&own == first_camera_for(CameraSensor::kKeypoints, context.servicer))
      telecommands.add(target_model_of(context.mission, camera, context.data_directory));
  }
  if (camera.has_use(CameraSensor::kBearings)) {
    auto configuration = shared.angles_only;
    configuration.exposure_s = camera.settings.exposure_s;
    if (known.centroid_floor_px)
      configuration.centroid_floor_px = std::max(configuration.centroid_floor_px, *known.centroid_floor_px);
    telecommands.add(configuration, unit);
  }
}

}  // namespace vbar::sensors
