#pragma once
// Attitudes of the spacecraft of a mission at the start of the run.

#include <filesystem>

#include "host_sim/mission/mission.h"
#include "host_sim/truth/truth_model.h"

namespace vbar::app {

/// Gives every spacecraft of the mission that has an attitude its own, from the truth's current time on; what the
/// mission file leaves open is drawn from the seed. All spacecraft must be there. Throws mission::MissionError for a
/// invalid body file, std::runtime_error, naming the spacecraft, for an attitude that cannot be.
void set_attitudes(const mission::Mission& mission, const std::filesystem::path& data_directory,
                   truth::TruthModel& truth);

}  // namespace vbar::app
