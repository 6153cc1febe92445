#include "host_sim/app/make_twins.h"

#include <stdexcept>
#include <utility>

#include "host_sim/twins/gnss_sensor.h"
#include "host_sim/twins/ideal_navigation.h"
#include "host_sim/twins/ideal_thruster.h"
#include "host_sim/twins/recorded_log.h"

namespace vbar::app {

namespace {

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

std::unique_ptr<twins::PacketSource> make_gnss_sensor(const mission::Mission& mission,
                                                      const mission::Spacecraft& spacecraft,
                                                      const mission::Spacecraft& servicer,
                                                      const std::shared_ptr<const twins::gnss::Constellation>& sky,
                                                      const std::filesystem::path& data_directory) {
  const twins::gnss::GnssReceiverSettings& settings = spacecraft.gnss->receiver;
  twins::GnssSensor::Settings sensor;
  sensor.spacecraft = spacecraft.name;
  sensor.flight_number = servicer.number;
  sensor.start = mission.start_time();
  sensor.period = fsw::nearest_duration(settings.output.period_s);
  std::unique_ptr<twins::gnss::Crosslink> crosslink;
  if (&spacecraft != &servicer)
    crosslink = std::make_unique<twins::gnss::Crosslink>(mission.crosslink, mission.seed, spacecraft.name);
  auto receiver =
      std::make_unique<twins::gnss::GnssReceiver>(settings, sky, data_directory, mission.seed, spacecraft.name);
  return std::make_unique<twins::GnssSensor>(sensor, std::move(receiver), std::move(crosslink));
}

}  // namespace

std::vector<std::unique_ptr<twins::PacketSource>> make_sensors(const mission::Mission& mission,
                                                               const mission::Spacecraft& servicer,
                                                               const std::filesystem::path& data_directory) {
  std::vector<std::unique_ptr<twins::PacketSource>> sensors;
  if (servicer.navigation) sensors.push_back(make_navigation_source(mission, servicer));
  if (servicer.gnss) {
    const auto sky = std::make_shared<const twins::gnss::Constellation>(data_directory, mission.constellation,
                                                                        mission.start_time(), mission.seed);
    for (const mission::Spacecraft* spacecraft : {&servicer, mission.find_spacecraft(servicer.gnss->partner)})
      sensors.push_back(make_gnss_sensor(mission, *spacecraft, servicer, sky, data_directory));
  }
  return sensors;
}

twins::camera::TileRestorer::MakeImage make_image_maker(const mission::Mission& /*mission*/,
                                                        const mission::Spacecraft& servicer,
                                                        const std::filesystem::path& /*data_directory*/) {
  throw std::runtime_error("spacecraft \"" + servicer.name +
                           "\" has no digital camera that could make the images of the log again");
}

std::optional<double> gnss_static_floor_m(const mission::Mission& mission, const mission::Spacecraft& servicer) {
  if (!servicer.gnss) return std::nullopt;
  const mission::Spacecraft& partner = *mission.find_spacecraft(servicer.gnss->partner);
  const twins::gnss::BodyFrameSettings& ours = servicer.gnss->receiver.body_frame;
  const twins::gnss::BodyFrameSettings& theirs = partner.gnss->receiver.body_frame;
  const auto our_errors = twins::gnss::draw_body_frame(ours, mission.seed, servicer.name);
  const auto their_errors = twins::gnss::draw_body_frame(theirs, mission.seed, partner.name);
  return twins::gnss::static_floor_m(ours, our_errors, theirs, their_errors).norm();
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
