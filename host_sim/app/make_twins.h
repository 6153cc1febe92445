#pragma once
// From a mission's words to its sensors and actuators.

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "host_sim/app/simulation.h"
#include "host_sim/mission/mission.h"
#include "host_sim/twins/actuator.h"
#include "host_sim/twins/camera/recipe_log.h"
#include "host_sim/twins/packet_source.h"

namespace vbar::app {

/// What the flight software of `servicer` senses by: its navigation sensor, or its own and its partner's GNSS
/// receivers. Throws what a recorded log and GNSS data throw.
std::vector<Source> make_sources(const mission::Mission& mission, const mission::Spacecraft& servicer,
                                 const std::filesystem::path& data_directory);

/// Makes the images of the digital camera of `servicer` again, for a replay. Throws std::runtime_error if it has none.
twins::camera::TileRestorer::MakeImage make_image_maker(const mission::Mission& mission,
                                                        const mission::Spacecraft& servicer,
                                                        const std::filesystem::path& data_directory);

/// Distance (m) between where the antennas of `servicer` and its partner are and where navigation takes them to be,
/// from the run's own draws, as if the bodies had parallel axes. For the report only. None without a GNSS pair.
std::optional<double> gnss_static_floor_m(const mission::Mission& mission, const mission::Spacecraft& servicer);

/// `spacecraft` must have a thruster.
std::unique_ptr<twins::Actuator> make_thruster(const mission::Mission& mission, const mission::Spacecraft& spacecraft);

}  // namespace vbar::app
