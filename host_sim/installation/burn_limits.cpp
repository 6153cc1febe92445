#include "host_sim/installation/burn_limits.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "fsw/core/gps_time.h"
#include "fsw/orbit/finite_burn.h"

namespace vbar::sensors {

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
