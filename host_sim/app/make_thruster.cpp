#include "host_sim/app/make_thruster.h"

#include "host_sim/twins/ideal_thruster.h"

namespace vbar::app {

std::unique_ptr<twins::Actuator> make_thruster(const mission::Mission& mission, const mission::Spacecraft& spacecraft) {
  twins::IdealThruster::Settings settings;
  settings.spacecraft_number = spacecraft.number;
  settings.magnitude_error = spacecraft.thruster->magnitude_error;
  settings.pointing_error_rad = spacecraft.thruster->pointing_error_rad;
  return std::make_unique<twins::IdealThruster>(settings,
                                                engine::RandomStream(mission.seed, spacecraft.name + "/thruster"));
}

}  // namespace vbar::app
