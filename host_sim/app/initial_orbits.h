#pragma once
// Puts the spacecraft of a mission on their orbits.

#include <filesystem>

#include "host_sim/mission/mission.h"
#include "host_sim/truth/truth_model.h"

namespace vbar::app {

/// Returns the truth settings of the mission, with the data in `data_directory`. Throws mission::MissionError for a
/// data file that the mission names and that cannot be opened.
truth::TruthSettings truth_settings(const mission::Mission& mission, const std::filesystem::path& data_directory);

/// Adds every spacecraft of `mission` to `truth`, which stands at the mission's epoch, in the mission's order of kinds:
/// those given by elements or by a file (absolute, or in `data_directory`) fly from the epoch to the start unburned;
/// those given by a waypoint or by ROE are then placed about the spacecraft they refer to, by its true mean elements at
/// the start. A spacecraft with a GNSS receiver gets the mass that its body frame's errors draw. Throws
/// std::runtime_error that names the spacecraft whose elements give no orbit, and what orbit files throw.
void place_spacecraft(const mission::Mission& mission, const std::filesystem::path& data_directory,
                      truth::TruthModel& truth);

}  // namespace vbar::app
