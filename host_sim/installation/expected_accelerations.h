#pragma once
// Differential accelerations that navigation has to expect: drag and radiation pressure of the target relative to the
// servicer, from the orbit, the solar activity and what is known of both surfaces before the flight. The process noise
// of the relative orbit must cover them.

#include <string>
#include <vector>

#include "fsw/orbit/elements.h"
#include "fsw/packets/messages.h"
#include "host_sim/mission/mission.h"
#include "host_sim/truth/force_list.h"

namespace vbar::sensors {

/// Root mean squares over the bounds of the target's surface, m/s^2: drag along a revolution, radiation pressure in
/// sunlight. Zero for a force that the mission does not have.
struct ExpectedAccelerations {
  double drag = 0.0;
  double radiation = 0.0;
  double period_s = 0.0;  ///< of the orbit
};

/// Returns the accelerations on the orbit of the servicer, in the atmosphere of the truth with the indices of the
/// start. The servicer's own surface is known; that of the target lies within the bounds of [navigation], by default
/// half to one and a half of its nominal values. Throws what the atmosphere throws.
[[nodiscard]] ExpectedAccelerations expected_accelerations(const mission::Mission& mission,
                                                           const mission::Spacecraft& servicer,
                                                           const mission::Spacecraft& target,
                                                           const truth::ForceData& environment,
                                                           const fsw::orbit::CartesianState& servicer_state);

/// Returns the mean acceleration over an orbital period that white noise of a power spectral density, m^2/s^3, stands
/// for: 1 sigma, m/s^2.
[[nodiscard]] double acceleration_of_noise(double psd, double period_s);

/// Raises the limit of the process noise and its initial value, unless the mission states them, where the default does
/// not cover what is expected; elsewhere nothing changes.
void cover(const ExpectedAccelerations& expected, bool is_stated, vbar::navigation_configuration& configuration);

/// Returns sentences on process noise that was raised, and on stated one that does not cover what is expected, with the
/// key to change.
[[nodiscard]] std::vector<std::string> notes_on(const ExpectedAccelerations& expected, const mission::Mission& mission,
                                                const vbar::navigation_configuration& covered);

/// The mission with process noise that covers the accelerations that are expected, and sentences on keys of
/// [navigation] without effect and on that noise. Unchanged with true states in place of an estimate.
struct CoveredMission {
  mission::Mission mission;
  std::vector<std::string> notes;
};
[[nodiscard]] CoveredMission with_expected_accelerations(const mission::Mission& mission,
                                                         const mission::Spacecraft& servicer,
                                                         const truth::ForceData& environment,
                                                         const fsw::orbit::CartesianState& servicer_state);

}  // namespace vbar::sensors
