#include "host_sim/mission/telecommands.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "fsw/math/math.h"
#include "fsw/orbit/mean_osculating.h"
#include "fsw/orbit/roe.h"
#include "host_sim/engine/random_stream.h"
#include "host_sim/mission/body_file.h"
#include "host_sim/mission/data_directory.h"

namespace vbar::mission {
namespace {

using fsw::orbit::QnsElements;

constexpr const char* kNoOrbit =
    "the target's a-priori state is no orbit: the sigmas of the section apriori are too large";

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

}  // namespace

vbar::waypoint_table waypoint_table_of(const Mission& mission) {
  vbar::waypoint_table table{};
  table.reference_semi_major_axis_m = mission.guidance.reference_semi_major_axis_m;
  for (const Waypoint& waypoint : mission.waypoints) {
    vbar::waypoint& entry = table.waypoints[table.count++];
    entry.index = waypoint.index;
    entry.control_mode = static_cast<std::int8_t>(waypoint.solver);
    entry.gps_time_ns = waypoint.time.ns;
    std::copy(waypoint.a_roe_m.begin(), waypoint.a_roe_m.end(), entry.a_roe_m);
  }
  return table;
}

vbar::gnc_configuration gnc_configuration_of(const Mission& mission) {
  const Guidance& guidance = mission.guidance;
  vbar::gnc_configuration configuration{};
  configuration.compute_latency_ns = guidance.compute_latency.ns;
  configuration.closed_form_period_ns = guidance.closed_form_period.ns;
  configuration.koenig_damico_period_ns = guidance.koenig_damico_period.ns;
  configuration.koenig_damico_grid_ns = guidance.koenig_damico_grid.ns;
  configuration.planner_start_ns = guidance.planner_start.ns;
  configuration.minimum_dv = guidance.minimum_dv;
  configuration.maximum_dv = guidance.maximum_dv;
  configuration.roe_error_threshold_m = guidance.roe_error_threshold_m;
  configuration.keep_out_radius_m = guidance.keep_out_radius_m;
  configuration.safety_horizon_s = guidance.safety_horizon_s;
  configuration.station_keeping_deadband_m = guidance.station_keeping_deadband_m;
  configuration.closed_form_tolerance_m = guidance.closed_form_tolerance_m;
  configuration.koenig_damico_tolerance_m = guidance.koenig_damico_tolerance_m;
  configuration.station_keeping_horizon_s = guidance.station_keeping_horizon_s;
  configuration.navigation_timeout_s = guidance.navigation_timeout_s;
  return configuration;
}

namespace {

std::int8_t source_of(const Spacecraft& servicer) {
  if (!servicer.camera) return navigation_configuration::kSourceGnss;
  return servicer.camera->navigation == CameraNavigation::kPose ? navigation_configuration::kSourcePose
                                                                : navigation_configuration::kSourceAnglesOnly;
}

}  // namespace

vbar::navigation_configuration navigation_configuration_of(const Mission& mission, const Spacecraft& servicer,
                                                           const truth::EarthOrientationSeries& orientation) {
  const GnssNavigation& navigation = mission.gnss_navigation;
  vbar::navigation_configuration configuration{};
  configuration.source = source_of(servicer);
  configuration.resolve_ambiguities = navigation.resolve_ambiguities ? 1 : 0;
  configuration.min_success_rate = navigation.min_success_rate;
  configuration.min_ratio = navigation.min_ratio;
  configuration.pair_wait_ns = navigation.pair_wait.ns;
  const auto copy_antenna = [](const Spacecraft& spacecraft, double(&antenna_m)[3]) {
    const fsw::Vector3& nominal = spacecraft.gnss->receiver.body_frame.antenna_in_body_m;
    std::copy(nominal.begin(), nominal.end(), antenna_m);
  };
  copy_antenna(servicer, configuration.servicer_antenna_body_m);
  if (const Spacecraft* const partner = mission.find_spacecraft(servicer.gnss->partner))
    copy_antenna(*partner, configuration.target_antenna_body_m);
  configuration.antenna_offset_sigma_m = navigation.antenna_offset_sigma_m;
  configuration.phase_centre_jitter_m = navigation.phase_centre_jitter_m;
  configuration.code_bias_sigma_m = navigation.code_bias_sigma_m;
  configuration.start_velocity_sigma = navigation.start_velocity_sigma;
  configuration.acceleration_sigma = navigation.acceleration_sigma;
  configuration.acceleration_time_s = navigation.acceleration_time_s;
  configuration.maneuver_sigma = navigation.maneuver_sigma;
  configuration.maneuver_sigma_relative = navigation.maneuver_sigma_relative;
  // GPS time is 19 s behind TAI. A prediction is told to what the IERS bulletins print: 10 us and 10 uas.
  constexpr double kGpsMinusTai_s = -19.0;
  constexpr double kLookAhead_s = 3600.0;
  const truth::EarthOrientation now = orientation.at(mission.start_time());
  const truth::EarthOrientation later = orientation.at(mission.start_time(), kLookAhead_s);
  configuration.earth_epoch_ns = mission.start_time().ns;
  configuration.ut1_minus_gps_s = 1e-5 * std::round(1e5 * (now.ut1_minus_tai_s - kGpsMinusTai_s));
  configuration.ut1_rate = (later.ut1_minus_tai_s - now.ut1_minus_tai_s) / kLookAhead_s;
  constexpr double kTenMicroarcseconds = 1e-5 * fsw::math::kPi / 648000.0;
  configuration.pole_x = kTenMicroarcseconds * std::round(now.pole_x / kTenMicroarcseconds);
  configuration.pole_y = kTenMicroarcseconds * std::round(now.pole_y / kTenMicroarcseconds);
  return configuration;
}

vbar::camera_configuration camera_configuration_of(const Spacecraft& servicer) {
  const CameraSensor& camera = *servicer.camera;
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

vbar::angles_only_configuration angles_only_configuration_of(const Mission& mission) {
  const AnglesOnly& navigation = mission.angles_only;
  vbar::angles_only_configuration configuration{};
  configuration.detection_sigmas = navigation.detection_sigmas;
  configuration.centroid_floor_px = navigation.centroid_floor_px;
  configuration.pointing_tolerance = navigation.pointing_tolerance;
  configuration.acceleration_psd = navigation.acceleration_psd;
  configuration.acceleration_psd_least = navigation.acceleration_psd_least;
  configuration.acceleration_psd_most = navigation.acceleration_psd_most;
  configuration.brightness_offset_m = navigation.brightness_offset_m;
  configuration.maneuver_sigma = navigation.maneuver_sigma;
  configuration.maneuver_sigma_relative = navigation.maneuver_sigma_relative;
  configuration.batch_images = navigation.batch_images;
  return configuration;
}

vbar::pose_configuration pose_configuration_of(const Mission& mission, const Spacecraft& servicer) {
  const PoseNavigation& navigation = mission.pose;
  const twins::camera::CameraSettings& camera = servicer.camera->settings;
  const twins::camera::DetectorSettings& detector = camera.detector;
  vbar::pose_configuration configuration{};
  const double dark_electrons = detector.dark_electrons_per_s * camera.exposure_s;
  configuration.dark_level_dn = detector.offset_dn + detector.gain_dn_per_electron * dark_electrons;
  constexpr double kRounding = 1.0 / 12.0;  // variance, DN^2
  const double read_dn = detector.gain_dn_per_electron * detector.read_noise_electrons;
  configuration.noise_dn = std::sqrt(
      read_dn * read_dn + detector.gain_dn_per_electron * detector.gain_dn_per_electron * dark_electrons + kRounding);
  const Spacecraft& target = *mission.find_spacecraft(servicer.camera->target);
  const Tumble& tumble = std::get<Tumble>(*target.attitude);  // the loader sees to it
  const truth::Body body = load_body(data_directory() / "bodies" / (tumble.body + ".toml"));
  constexpr std::size_t kKeypoints = sizeof configuration.keypoints_body_m / (3 * sizeof(double));
  const auto keypoints_m = load_keypoints(data_directory() / "models" / (target.model + "_keypoints.toml"), kKeypoints);
  for (std::size_t k = 0; k < kKeypoints; ++k) {
    const fsw::Vector3 from_centre_of_mass = keypoints_m[k] - body.centre_of_mass_m;
    std::ranges::copy(from_centre_of_mass, configuration.keypoints_body_m + 3 * k);
  }
  const fsw::Matrix3 I = tumble.inertia_kgm2.value_or(body.inertia_kgm2);
  std::ranges::copy(std::array{I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2)}, configuration.inertia_kgm2);
  configuration.keypoint_sigma_scale = navigation.keypoint_sigma_scale;
  configuration.keypoint_floor_px = navigation.keypoint_floor_px;
  configuration.acceleration_psd = navigation.acceleration_psd;
  configuration.acceleration_psd_least = navigation.acceleration_psd_least;
  configuration.acceleration_psd_most = navigation.acceleration_psd_most;
  configuration.angular_acceleration_psd = navigation.angular_acceleration_psd;
  configuration.maneuver_sigma = navigation.maneuver_sigma;
  configuration.maneuver_sigma_relative = navigation.maneuver_sigma_relative;
  std::ranges::copy(navigation.start_sigma_a_roe_m, configuration.start_sigma_a_roe_m);
  configuration.start_images = navigation.start_images;
  return configuration;
}

void add_apriori(const Mission& mission, const Spacecraft& servicer, const fsw::orbit::CartesianState& servicer_state,
                 const fsw::orbit::CartesianState& target_state, vbar::pose_configuration& configuration) {
  const fsw::Vector6& sigma_m = mission.pose.apriori_sigma_a_roe_m;
  if (sigma_m.isZero(0.0)) return;
  const QnsElements chief = mean_of(servicer_state);
  const fsw::Vector6 a_roe_m = chief.a * drawn_roe(chief, target_state, sigma_m, mission, servicer);
  configuration.apriori_epoch_ns = mission.start_time().ns;
  std::ranges::copy(a_roe_m, configuration.apriori_a_roe_m);
  std::ranges::copy(sigma_m, configuration.apriori_sigma_a_roe_m);
}

vbar::target_apriori target_apriori_of(const Mission& mission, const Spacecraft& servicer,
                                       const fsw::orbit::CartesianState& servicer_state,
                                       const fsw::orbit::CartesianState& target_state) {
  const QnsElements chief = mean_of(servicer_state);
  const fsw::Vector6& sigma_m = mission.angles_only.apriori_sigma_a_roe_m;
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

vbar::mode_command mode_command_of(const Mission& mission) {
  vbar::mode_command command{};
  command.mode = static_cast<std::int8_t>(mission.guidance.mode);
  return command;
}

}  // namespace vbar::mission
