#pragma once
// Puts the spacecraft of a mission on their orbits.

#include <filesystem>

#include "fsw/orbit/elements.h"
#include "host_sim/mission/mission.h"
#include "host_sim/truth/truth_model.h"

namespace vbar::app {

/// Returns the truth settings of the mission, with the data in `data_directory`. Throws mission::MissionError for a
/// data file that the mission names and that cannot be opened.
truth::TruthSettings truth_settings(const mission::Mission& mission, const std::filesystem::path& data_directory);

/// Returns the surface properties of a spacecraft with its true mass, drawn from the seed. Throws std::runtime_error if
/// that is not positive.
truth::SurfaceProperties true_surface(const mission::Mission& mission, const mission::Spacecraft& spacecraft);

/// Adds every spacecraft of `mission` to `truth`, which stands at the mission's epoch, in the mission's order of kinds:
/// those given by elements or by a file (absolute, or in `data_directory`) fly from the epoch to the start unburned;
/// those given by a waypoint or by ROE are then placed about the spacecraft they refer to, by its true mean elements at
/// the start. A spacecraft with a GNSS receiver gets the mass that its body frame's errors draw. Throws
/// std::runtime_error that names the spacecraft whose elements give no orbit, and what orbit files throw.
void place_spacecraft(const mission::Mission& mission, const std::filesystem::path& data_directory,
                      truth::TruthModel& truth);

// Attitudes of the spacecraft of a mission at the start of the run.

/// Gives every spacecraft of the mission that has an attitude its own, from the truth's current time on; what the
/// mission file leaves open is drawn from the seed. All spacecraft must be there. Throws mission::MissionError for a
/// invalid body file, std::runtime_error, naming the spacecraft, for an attitude that cannot be.
void set_attitudes(const mission::Mission& mission, const std::filesystem::path& data_directory,
                   truth::TruthModel& truth);

// The orbits that the maneuver planners of the flight software are made for.

/// Throws std::runtime_error that names waypoint, planner and its domain if vbar's flight software would plan a leg of
/// an approach on an orbit (state of the servicer at the start, GCRF) outside it, and for a mission that reaches
/// beyond the times of its packets; for any flight software if the orbit has no mean elements, which the record needs.
void check_guidance_domain(const mission::Mission& mission, const mission::Spacecraft& servicer,
                           const fsw::orbit::CartesianState& servicer_state);

}  // namespace vbar::app
