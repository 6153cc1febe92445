#include "host_sim/app/make_twins.h"

#include "host_sim/twins/ideal_navigation.h"
#include "host_sim/twins/ideal_thruster.h"
#include "host_sim/twins/recorded_log.h"

namespace vbar::app {

std::unique_ptr<twins::PacketSource> make_navigation_source(const mission::Mission& mission,
                                                            const mission::Spacecraft& spacecraft) {
  const mission::NavigationSensor& sensor = *spacecraft.navigation;
  if (sensor.source == mission::NavigationSource::kRecorded) {
    const twins::RecordedLog::Selection selection{spacecraft.number, fsw::packets::Apid::kIdealNavigation};
    return std::make_unique<twins::RecordedLog>(sensor.log, selection);
  }
  twins::IdealNavigation::Settings settings;
  settings.servicer = spacecraft.name;
  settings.servicer_number = spacecraft.number;
  settings.target = sensor.target;
  settings.start = mission.start_time();
  settings.period = sensor.period;
  return std::make_unique<twins::IdealNavigation>(settings);
}

std::unique_ptr<twins::Actuator> make_thruster(const mission::Mission& mission, const mission::Spacecraft& spacecraft) {
  twins::IdealThruster::Settings settings;
  settings.spacecraft_number = spacecraft.number;
  settings.magnitude_error = spacecraft.thruster->magnitude_error;
  settings.pointing_error_rad = spacecraft.thruster->pointing_error_rad;
  return std::make_unique<twins::IdealThruster>(settings,
                                                engine::RandomStream(mission.seed, spacecraft.name + "/thruster"));
}

}  // namespace vbar::app
