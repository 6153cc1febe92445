#include <algorithm>
#include <array>
#include <cmath>

#include "host_sim/mission/body_file.h"
#include "host_sim/sensors/camera/camera_kind.h"
#include "host_sim/sensors/camera/known_camera.h"

namespace vbar::sensors {
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
