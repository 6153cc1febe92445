#include "host_sim/installation/expected_accelerations.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "fsw/orbit/propagate.h"
#include "host_sim/installation/navigation_telecommands.h"
#include "host_sim/mission/mission.h"
#include "host_sim/truth/earth/earth_rotation.h"
#include "host_sim/truth/forces/drag_force.h"

namespace vbar::sensors {
namespace {

using mission::Mission;
using mission::Spacecraft;
using mission::SurfaceBounds;

constexpr double kRadiationPressure = 4.56e-6;  // N/m^2 at 1 au: solar constant over the speed of light
constexpr int kSamples = 24;                    // of a revolution
// Limits of the process noise for two like spacecraft at 700 km, m^2/s^3.
constexpr double kDefaultPsdMax = 1e-11;
// The process noise begins this far below its limit; what acts on average, drag, is a state.
constexpr double kStartShare = 1e-2;
// A stated limit is reported as too small if it covers less than this share of what is expected.
constexpr double kCoveredShare = 0.5;

double drag_m2_per_kg(const truth::SurfaceProperties& surface) {
  return surface.mass_kg > 0.0 ? surface.drag_coefficient * surface.drag_area_m2 / surface.mass_kg : 0.0;
}

double radiation_m2_per_kg(const truth::SurfaceProperties& surface) {
  return surface.mass_kg > 0.0 ? surface.radiation_coefficient * surface.radiation_area_m2 / surface.mass_kg : 0.0;
}

SurfaceBounds default_bounds(double nominal) {
  return {0.5 * nominal, 1.5 * nominal};
}

/// Root mean square of the difference from `own` of a value that is uniform within the bounds.
double rms_difference(double own, const SurfaceBounds& bounds) {
  const double mean = 0.5 * (bounds.min_m2_per_kg + bounds.max_m2_per_kg);
  const double width = bounds.max_m2_per_kg - bounds.min_m2_per_kg;
  return std::sqrt((mean - own) * (mean - own) + width * width / 12.0);
}

/// Drag along a revolution on one m^2/kg: root mean square, m/s^2.
double unit_drag(const Mission& mission, const truth::ForceData& environment, const fsw::orbit::CartesianState& start,
                 double period_s) {
  const truth::SurfaceProperties unit{.mass_kg = 1.0, .drag_area_m2 = 1.0, .drag_coefficient = 1.0};
  truth::DragForce drag(unit, environment.atmosphere, environment.space_weather, mission.truth.forces.geomagnetic_index,
                        mission.start_time());
  truth::EarthRotation rotation(environment.earth_orientation, mission.start_time());
  double squares = 0.0;
  for (int k = 0; k < kSamples; ++k) {
    const double after_s = k * period_s / kSamples;
    const auto state = fsw::orbit::propagate_j2(start, after_s);
    if (!state.ok()) return 0.0;
    truth::ForceInput input;
    input.seconds = after_s;
    input.position_eci = state.value().position_eci;
    input.velocity_eci = state.value().velocity_eci;
    input.R_itrf_gcrf = rotation.R_itrf_gcrf_at(after_s);
    input.position_itrf = input.R_itrf_gcrf * input.position_eci;
    squares += drag.acceleration_eci(input).squaredNorm();
  }
  return std::sqrt(squares / kSamples);
}

}  // namespace

ExpectedAccelerations expected_accelerations(const Mission& mission, const Spacecraft& servicer,
                                             const Spacecraft& target, const truth::ForceData& environment,
                                             const fsw::orbit::CartesianState& servicer_state) {
  ExpectedAccelerations expected;
  const auto elements = fsw::orbit::qns_from_cartesian(servicer_state);
  if (!elements.ok()) return expected;
  expected.period_s = 2.0 * M_PI / fsw::orbit::mean_motion(elements.value().a);
  const auto& keys = mission::shared_settings<mission::ProcessNoiseKeys>(mission);
  if (mission.truth.forces.drag && environment.atmosphere && environment.space_weather) {
    const SurfaceBounds bounds = keys.target_drag.value_or(default_bounds(drag_m2_per_kg(target.surface)));
    expected.drag = rms_difference(drag_m2_per_kg(servicer.surface), bounds) *
                    unit_drag(mission, environment, servicer_state, expected.period_s);
  }
  if (mission.truth.forces.radiation_pressure) {
    const SurfaceBounds bounds = keys.target_radiation.value_or(default_bounds(radiation_m2_per_kg(target.surface)));
    expected.radiation = rms_difference(radiation_m2_per_kg(servicer.surface), bounds) * kRadiationPressure;
  }
  return expected;
}

double acceleration_of_noise(double psd, double period_s) {
  return std::sqrt(psd / period_s);
}

void cover(const ExpectedAccelerations& expected, bool is_stated, vbar::navigation_configuration& configuration) {
  if (is_stated || !(expected.period_s > 0.0)) return;
  const double together = std::hypot(expected.drag, expected.radiation);
  if (!(together > acceleration_of_noise(kDefaultPsdMax, expected.period_s))) return;
  configuration.acceleration_psd_most =
      std::max(configuration.acceleration_psd_most, together * together * expected.period_s);
  configuration.acceleration_psd =
      std::max(configuration.acceleration_psd, kStartShare * configuration.acceleration_psd_most);
}

std::vector<std::string> notes_on(const ExpectedAccelerations& expected, const Mission& mission,
                                  const vbar::navigation_configuration& covered) {
  std::vector<std::string> notes;
  if (!(expected.period_s > 0.0)) return notes;
  const bool is_stated = mission::shared_settings<mission::ProcessNoiseKeys>(mission).are_stated;
  const double together = std::hypot(expected.drag, expected.radiation);
  const double by_default = acceleration_of_noise(kDefaultPsdMax, expected.period_s);
  const double allowed = acceleration_of_noise(covered.acceleration_psd_most, expected.period_s);
  const std::string what = fmt::format(
      "the expected differential acceleration is {:.1e} m/s^2 (drag {:.1e}, radiation pressure {:.1e}; bounds of the "
      "target: navigation.target_drag_m2_per_kg, target_radiation_m2_per_kg)",
      together, expected.drag, expected.radiation);
  if (is_stated && kCoveredShare * together > allowed) {
    notes.push_back(
        fmt::format("Navigation: {}; the stated navigation.acceleration_psd_max = {:.1e} m^2/s^3 covers {:.1e}: the "
                    "estimate may be "
                    "lost. Without that key it is {:.1e}.",
                    what, covered.acceleration_psd_most, allowed, together * together * expected.period_s));
  } else if (!is_stated && together > by_default) {
    notes.push_back(
        fmt::format("Navigation: {}, above the {:.1e} of the default process noise; "
                    "navigation.acceleration_psd_max is raised to {:.1e} m^2/s^3.",
                    what, by_default, covered.acceleration_psd_most));
  }
  if (mission.safety && expected.drag > by_default && expected.drag > mission.safety->differential_drag)
    notes.push_back(fmt::format("Safety: {}; the retreat allows for safety.differential_drag_mps2 = {:.1e}.", what,
                                mission.safety->differential_drag));
  return notes;
}

CoveredMission with_expected_accelerations(const Mission& mission, const Spacecraft& servicer,
                                           const truth::ForceData& environment,
                                           const fsw::orbit::CartesianState& servicer_state) {
  CoveredMission covered{mission, {}};
  const std::int32_t sources = sources_of(servicer);
  const Spacecraft* const target = mission.find_spacecraft(servicer.observes());
  using Use = vbar::navigation_configuration;
  if (target == nullptr || sources == 0 || (sources & Use::kUseIdeal) != 0) return covered;
  const auto& keys = mission::shared_settings<mission::ProcessNoiseKeys>(mission);
  const ExpectedAccelerations expected =
      expected_accelerations(mission, servicer, *target, environment, servicer_state);
  vbar::navigation_configuration& configuration = covered.mission.navigation.configuration;
  cover(expected, keys.are_stated, configuration);
  covered.notes = keys.without_effect;
  // Without a camera an empirical acceleration takes the place of this noise.
  if ((sources & (std::int32_t{Use::kUseBearings} | Use::kUseKeypoints)) == 0) return covered;
  const std::vector<std::string> of_noise = notes_on(expected, mission, configuration);
  covered.notes.insert(covered.notes.end(), of_noise.begin(), of_noise.end());
  return covered;
}

}  // namespace vbar::sensors
