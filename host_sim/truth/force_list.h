#pragma once
// The forces on a spacecraft from the switches of a mission.

#include <memory>
#include <string>
#include <vector>

#include "fsw/core/gps_time.h"
#include "host_sim/truth/atmosphere/nrlmsise00_tables.h"
#include "host_sim/truth/earth/earth_orientation.h"
#include "host_sim/truth/earth/space_weather.h"
#include "host_sim/truth/forces/force.h"
#include "host_sim/truth/forces/gravitation.h"
#include "host_sim/truth/forces/solid_tides.h"
#include "host_sim/truth/truth_settings.h"

namespace vbar::truth {

/// Large constant data: loaded once, shared by the forces of all spacecraft and by all threads.
struct ForceData {
  std::shared_ptr<const GravityField> gravity;
  TideSystem tide_system = TideSystem::kZeroTide;  ///< tide system of the gravity model; read only if the tides act
  std::shared_ptr<const EarthOrientationSeries> earth_orientation;
  std::shared_ptr<const Nrlmsise00Tables> atmosphere;  ///< null without drag, as is the next
  std::shared_ptr<const SpaceWeather> space_weather;
  std::vector<std::string> notes;  ///< a sentence on each that is missing or predicted, with the size of the error
};

/// Loads what the forces of `settings` need. Throws std::runtime_error for a missing or damaged file,
/// std::invalid_argument for a degree or order above the gravity file's, std::out_of_range if the data do not
/// reach from the epoch to the end.
ForceData load_force_data(const TruthSettings& settings);

/// Loads the atmosphere and its solar indices, which load_force_data() omits without drag; nothing if they are
/// loaded. Throws as load_force_data().
void load_atmosphere(const TruthSettings& settings, ForceData& data);

/// Makes the forces on one spacecraft, gravity first. Throws std::invalid_argument, naming spacecraft, force and
/// property, if a force needs a mass, an area or a coefficient that the spacecraft does not have.
std::vector<std::unique_ptr<Force>> make_forces(const TruthSettings& settings, const ForceData& data,
                                                const SpacecraftSettings& spacecraft);

// Earth orientation and space weather of a run: from the file that is named, from the data folder, or assumed. What is
// assumed or predicted is noted with the size of the error.

/// Load data of the Earth. Both throw std::runtime_error for a missing or damaged file or, where settings do not accept
/// predictions, a predicted value, and std::out_of_range if a file that is named does not reach from the epoch to the
/// end.
void load_earth_orientation(const TruthSettings& settings, ForceData& data);
void load_space_weather(const TruthSettings& settings, ForceData& data);

}  // namespace vbar::truth
