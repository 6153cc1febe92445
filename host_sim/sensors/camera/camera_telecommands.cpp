#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "fsw/orbit/mean_osculating.h"
#include "fsw/orbit/roe.h"
#include "host_sim/engine/random_stream.h"
#include "host_sim/mission/body_file.h"
#include "host_sim/sensors/camera/camera_kind.h"
#include "host_sim/sensors/camera/known_camera.h"

namespace vbar::sensors {
namespace {

using fsw::orbit::QnsElements;
using mission::Mission;
using mission::Spacecraft;

constexpr const char* kNoOrbit =
    "the target's a-priori state is not an orbit: the sigmas of the section apriori are too large";

QnsElements mean_of(const fsw::orbit::CartesianState& state) {
  const auto osculating = fsw::orbit::qns_from_cartesian(state);
  if (!osculating.ok()) throw std::runtime_error(kNoOrbit);
  const auto mean = fsw::orbit::mean_from_osculating(osculating.value());
  if (!mean.ok()) throw std::runtime_error(kNoOrbit);
  return mean.value();
}

/// Off by what the seed draws.
fsw::Vector6 drawn_roe(const QnsElements& chief_mean, const fsw::orbit::CartesianState& target_state,
                       const fsw::Vector6& sigma_a_roe_m, const Mission& mission, const Spacecraft& servicer) {
  fsw::Vector6 roe = fsw::orbit::roe_from_qns(chief_mean, mean_of(target_state));
  engine::RandomStream random(mission.seed, servicer.name + "/target_apriori");
  for (Eigen::Index k = 0; k < 6; ++k)
    roe(k) += sigma_a_roe_m(k) / mission.guidance.reference_semi_major_axis_m * random.normal();
  return roe;
}

/// Where navigation before the mission left the target, out of the true states of both at the start: mean ROE off by
/// what the seed draws with the mission's sigmas; nothing without those.
void add_apriori(const Mission& mission, const Spacecraft& servicer, const fsw::orbit::CartesianState& servicer_state,
                 const fsw::orbit::CartesianState& target_state, vbar::pose_configuration& configuration) {
  const fsw::Vector6 sigma_m(mission::shared_settings<CameraShared>(mission).pose.apriori_sigma_a_roe_m);
  if (sigma_m.isZero(0.0)) return;
  const QnsElements chief = mean_of(servicer_state);
  const fsw::Vector6 a_roe_m = chief.a * drawn_roe(chief, target_state, sigma_m, mission, servicer);
  configuration.apriori_epoch_ns = mission.start_time().ns;
  std::ranges::copy(a_roe_m, configuration.apriori_a_roe_m);
  std::ranges::copy(sigma_m, configuration.apriori_sigma_a_roe_m);
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
  const Eigen::Quaterniond& q = camera.q_camera_body;
  std::ranges::copy(std::array{q.w(), q.x(), q.y(), q.z()}, configuration.q_camera_body);
  std::ranges::copy(camera.position_body_m, configuration.position_body_m);
  return configuration;
}

vbar::pose_configuration pose_configuration_of(const Mission& mission, const CameraSensor& sensor,
                                               const std::filesystem::path& data_directory) {
  const twins::camera::CameraSettings& camera = sensor.settings;
  const twins::camera::DetectorSettings& detector = camera.detector;
  vbar::pose_configuration configuration = mission::shared_settings<CameraShared>(mission).pose;
  std::ranges::fill(configuration.apriori_sigma_a_roe_m, 0.0);
  const double dark_electrons = detector.dark_electrons_per_s * camera.exposure_s;
  configuration.dark_level_dn = detector.offset_dn + detector.gain_dn_per_electron * dark_electrons;
  constexpr double kRounding = 1.0 / 12.0;  // variance, DN^2
  const double read_dn = detector.gain_dn_per_electron * detector.read_noise_electrons;
  configuration.noise_dn = std::sqrt(
      read_dn * read_dn + detector.gain_dn_per_electron * detector.gain_dn_per_electron * dark_electrons + kRounding);
  const Spacecraft& target = *mission.find_spacecraft(sensor.observed);
  const mission::Tumble& tumble = std::get<mission::Tumble>(*target.attitude);  // the loader sees to it
  const truth::Body body = mission::load_body(data_directory / "bodies" / (tumble.body + ".toml"));
  constexpr std::size_t kKeypoints = sizeof configuration.keypoints_body_m / (3 * sizeof(double));
  const auto keypoints_m =
      mission::load_keypoints(data_directory / "models" / (target.model + "_keypoints.toml"), kKeypoints);
  for (std::size_t k = 0; k < kKeypoints; ++k) {
    const fsw::Vector3 from_centre_of_mass = keypoints_m[k] - body.centre_of_mass_m;
    std::ranges::copy(from_centre_of_mass, configuration.keypoints_body_m + 3 * k);
  }
  const fsw::Matrix3 I = tumble.inertia_kgm2.value_or(body.inertia_kgm2);
  std::ranges::copy(std::array{I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2)}, configuration.inertia_kgm2);
  return configuration;
}

vbar::target_apriori target_apriori_of(const Mission& mission, const Spacecraft& servicer,
                                       const fsw::orbit::CartesianState& servicer_state,
                                       const fsw::orbit::CartesianState& target_state) {
  const QnsElements chief = mean_of(servicer_state);
  const fsw::Vector6& sigma_m = mission::shared_settings<CameraShared>(mission).angles_only_apriori_sigma_a_roe_m;
  const fsw::Vector6 roe = drawn_roe(chief, target_state, sigma_m, mission, servicer);
  const auto osculating = fsw::orbit::osculating_from_mean(fsw::orbit::qns_from_roe(chief, roe));
  if (!osculating.ok()) throw std::runtime_error(kNoOrbit);
  const auto state = fsw::orbit::cartesian_from_qns(osculating.value());
  if (!state.ok()) throw std::runtime_error(kNoOrbit);
  vbar::target_apriori apriori{};
  std::ranges::copy(state.value().position_eci, apriori.position_eci);
  std::ranges::copy(state.value().velocity_eci, apriori.velocity_eci);
  std::ranges::copy(sigma_m, apriori.sigma_a_roe_m);
  return apriori;
}

void add_camera_telecommands(const mission::Sensor& sensor, const TelecommandContext& context,
                             Telecommands& telecommands) {
  if (settings_of<CameraSensor>(sensor).use == CameraNavigation::kNone) return;
  const KnownCamera known = known_camera(settings_of<CameraSensor>(sensor), context.mission, context.data_directory);
  const CameraSensor& camera = known.sensor;
  telecommands.add(camera_configuration_of(camera));
  const fsw::orbit::CartesianState own = context.state_at_start(context.servicer.name);
  const fsw::orbit::CartesianState target = context.state_at_start(camera.observed);
  if (camera.use == CameraNavigation::kPose) {
    auto configuration = pose_configuration_of(context.mission, camera, context.data_directory);
    add_apriori(context.mission, context.servicer, own, target, configuration);
    telecommands.add(configuration);
  } else {
    auto configuration = mission::shared_settings<CameraShared>(context.mission).angles_only;
    if (known.centroid_floor_px)
      configuration.centroid_floor_px = std::max(configuration.centroid_floor_px, *known.centroid_floor_px);
    telecommands.add(configuration);
    telecommands.add(target_apriori_of(context.mission, context.servicer, own, target));
  }
}

}  // namespace vbar::sensors
