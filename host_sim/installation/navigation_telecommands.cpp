#include "host_sim/installation/navigation_telecommands.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "fsw/core/gps_time.h"
#include "fsw/math/math.h"
#include "fsw/orbit/finite_burn.h"
#include "fsw/orbit/mean_osculating.h"
#include "fsw/orbit/roe.h"
#include "host_sim/engine/random_stream.h"

namespace vbar::sensors {

namespace {

using fsw::orbit::QnsElements;
using mission::Mission;
using mission::Spacecraft;
using Use = vbar::navigation_configuration;

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
                       const Mission& mission, const Spacecraft& servicer) {
  const fsw::Vector6& sigma_a_roe_m = mission.navigation.apriori_sigma_a_roe_m;
  fsw::Vector6 roe = fsw::orbit::roe_from_qns(chief_mean, mean_of(target_state));
  engine::RandomStream random(mission.seed, servicer.name + "/target_apriori");
  for (Eigen::Index k = 0; k < 6; ++k)
    roe(k) += sigma_a_roe_m(k) / mission.guidance.reference_semi_major_axis_m * random.normal();
  return roe;
}

constexpr std::int32_t kCameraUses = std::int32_t{Use::kUseBearings} + Use::kUseKeypoints;

/// The spacecraft that a camera navigates to; empty: no camera does.
std::string observed_by_camera(const Spacecraft& servicer) {
  const auto camera = std::ranges::find_if(
      servicer.sensors, [](const mission::Sensor& sensor) { return (sensor.settings->navigation & kCameraUses) != 0; });
  return camera == servicer.sensors.end() ? std::string() : camera->settings->observed;
}

}  // namespace

std::int32_t sources_of(const Spacecraft& servicer) {
  std::int32_t sources = 0;
  for (const mission::Sensor& sensor : servicer.sensors) sources |= sensor.settings->navigation;
  return (sources & Use::kUseIdeal) != 0 ? std::int32_t{Use::kUseIdeal} : sources;
}

vbar::navigation_configuration navigation_configuration_of(const Mission& mission, const Spacecraft& servicer) {
  vbar::navigation_configuration configuration = mission.navigation.configuration;
  configuration.sources = sources_of(servicer);
  return configuration;
}

vbar::earth_configuration earth_configuration_of(const Mission& mission,
                                                 const truth::EarthOrientationSeries& orientation) {
  vbar::earth_configuration configuration{};
  // GPS time is 19 s behind TAI. A prediction is rounded to what the IERS bulletins print: 10 us and 10 uas.
  constexpr double kGpsMinusTai_s = -19.0;
  constexpr double kLookAhead_s = 3600.0;
  const truth::EarthOrientation now = orientation.at(mission.start_time());
  const truth::EarthOrientation later = orientation.at(mission.start_time(), kLookAhead_s);
  configuration.epoch_ns = mission.start_time().ns;
  configuration.ut1_minus_gps_s = 1e-5 * std::round(1e5 * (now.ut1_minus_tai_s - kGpsMinusTai_s));
  configuration.ut1_rate = (later.ut1_minus_tai_s - now.ut1_minus_tai_s) / kLookAhead_s;
  constexpr double kTenMicroarcseconds = 1e-5 * fsw::math::kPi / 648000.0;
  configuration.pole_x = kTenMicroarcseconds * std::round(now.pole_x / kTenMicroarcseconds);
  configuration.pole_y = kTenMicroarcseconds * std::round(now.pole_y / kTenMicroarcseconds);
  return configuration;
}

vbar::target_apriori target_apriori_of(const Mission& mission, const Spacecraft& servicer,
                                       const fsw::orbit::CartesianState& servicer_state,
                                       const fsw::orbit::CartesianState& target_state) {
  const QnsElements chief = mean_of(servicer_state);
  const fsw::Vector6 roe = drawn_roe(chief, target_state, mission, servicer);
  vbar::target_apriori apriori{};
  std::ranges::copy(mission.navigation.apriori_sigma_a_roe_m, apriori.sigma_a_roe_m);
  if (mission.navigation.apriori == mission::Apriori::kRoe) {
    apriori.kind = vbar::target_apriori::kKindRoe;
    const fsw::Vector6 a_roe_m = chief.a * roe;
    std::ranges::copy(a_roe_m, apriori.mean_a_roe_m);
    return apriori;
  }
  const auto osculating = fsw::orbit::osculating_from_mean(fsw::orbit::qns_from_roe(chief, roe));
  if (!osculating.ok()) throw std::runtime_error(kNoOrbit);
  const auto state = fsw::orbit::cartesian_from_qns(osculating.value());
  if (!state.ok()) throw std::runtime_error(kNoOrbit);
  apriori.kind = vbar::target_apriori::kKindOrbit;
  std::ranges::copy(state.value().position_eci, apriori.position_eci);
  std::ranges::copy(state.value().velocity_eci, apriori.velocity_eci);
  return apriori;
}

void add_navigation_telecommands(const TelecommandContext& context, Telecommands& telecommands) {
  const std::int32_t sources = sources_of(context.servicer);
  const vbar::thruster_configuration thruster = thruster_configuration_of(context.mission, context.servicer);
  const bool is_ideal = sources == 0 || (sources & Use::kUseIdeal) != 0;
  if (!is_ideal || thruster.thrust_acceleration > 0.0) telecommands.add(thruster);
  if (is_ideal) return;
  telecommands.add(navigation_configuration_of(context.mission, context.servicer));
  telecommands.add(earth_configuration_of(context.mission, context.earth_orientation));
  const std::string observed = observed_by_camera(context.servicer);
  if (observed.empty() || context.mission.navigation.apriori == mission::Apriori::kNone) return;
  telecommands.add(target_apriori_of(context.mission, context.servicer, context.state_at_start(context.servicer.name),
                                     context.state_at_start(observed)));
}

void limit_burns(const mission::Spacecraft& servicer, vbar::gnc_configuration& configuration) {
  if (!servicer.thruster || !servicer.thruster->finite) return;
  const twins::ThrusterProperties& thruster = *servicer.thruster->finite;
  const double mass_kg = servicer.surface.mass_kg;
  const double least_mps = thruster.minimum_impulse_ns / mass_kg;
  // With the mass of the start: later burns of that size are shorter.
  const double open_s = thruster.maximum_on_time_s - 0.5 * (thruster.rise_s - thruster.fall_s);
  const double exhaust_mps = thruster.exhaust_velocity_mps();
  const double most_mps = -exhaust_mps * std::log1p(-thruster.thrust_n * open_s / (exhaust_mps * mass_kg));
  configuration.minimum_dv = std::max(configuration.minimum_dv, least_mps);
  configuration.maximum_dv = std::min(configuration.maximum_dv, most_mps);
  const double longest_s = thruster.maximum_on_time_s + thruster.fall_s;
  configuration.compute_latency_ns += fsw::nearest_duration(0.5 * longest_s).ns;
  if (!(configuration.maximum_dv > configuration.minimum_dv)) {
    throw std::runtime_error(
        fmt::format("spacecraft \"{}\": no burn is possible: the thruster gives {:.3g} to {:.3g} m/s, guidance plans "
                    "from dv_min_mmps to dv_max_mps",
                    servicer.name, least_mps, most_mps));
  }
}

vbar::thruster_configuration thruster_configuration_of(const mission::Mission& mission,
                                                       const mission::Spacecraft& servicer) {
  vbar::thruster_configuration configuration = mission.navigation.thruster;
  if (!servicer.thruster || !servicer.thruster->finite) return configuration;
  const twins::ThrusterProperties& thruster = *servicer.thruster->finite;
  configuration.thrust_acceleration = thruster.thrust_n / servicer.surface.mass_kg;
  configuration.pause_s = thruster.rise_s + thruster.fall_s;
  const double acceleration = configuration.thrust_acceleration;
  constexpr double kLeast = fsw::orbit::kLeastThrustAcceleration, kMost = fsw::orbit::kMostThrustAcceleration;
  if (!(acceleration >= kLeast && acceleration <= kMost)) {
    throw std::runtime_error(fmt::format(
        "spacecraft \"{}\": actuators.thruster.thrust_n: found {:g} N on {:g} kg, {:.3g} m/s^2; accepted: {:g} "
        "to {:g} m/s^2",
        servicer.name, thruster.thrust_n, servicer.surface.mass_kg, acceleration, kLeast, kMost));
  }
  return configuration;
}

std::string note_on_burns(const mission::Spacecraft& servicer, const vbar::gnc_configuration& stated) {
  if (!servicer.thruster || !servicer.thruster->finite) return {};
  vbar::gnc_configuration limited = stated;
  limit_burns(servicer, limited);
  return fmt::format(
      "Guidance: a thruster of {:g} N on {:g} kg executes burns of {:.3g} mm/s to {:.3g} m/s in up to {:g} s; they are "
      "centred on their time and commanded {:.0f} s before it.",
      servicer.thruster->finite->thrust_n, servicer.surface.mass_kg, 1e3 * limited.minimum_dv, limited.maximum_dv,
      servicer.thruster->finite->maximum_on_time_s, 1e-9 * static_cast<double>(limited.compute_latency_ns));
}

}  // namespace vbar::sensors
