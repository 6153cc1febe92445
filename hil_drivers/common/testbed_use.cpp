#include "hil_drivers/common/testbed_use.h"

#include <array>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "host_sim/report/verdict.h"
#include "host_sim/sensors/camera/camera_kind.h"
#include "host_sim/sensors/sensor_kind.h"

namespace vbar::testbeds {

OnFailure read_on_failure(const mission::TableReader& section) {
  constexpr std::array<std::pair<std::string_view, OnFailure>, 2> kNames{
      {{"stop", OnFailure::kStop}, {"twin", OnFailure::kTwin}}};
  return section.choice<OnFailure>("on_failure", kNames, OnFailure::kStop);
}

bool is_idle_after(const mission::Mission& mission, const std::string& camera, fsw::GpsTime time) {
  for (const mission::Spacecraft& carrier : mission.spacecraft) {
    for (const mission::Sensor& sensor : carrier.sensors) {
      if (sensors::source_name(carrier, sensor) != camera) continue;
      const auto next = sensors::settings_of<sensors::CameraSensor>(sensor).next_image(time + fsw::Duration{1});
      return !next || *next > time + kParkedFor;
    }
  }
  throw std::logic_error("the mission has no camera \"" + camera + "\"");
}

void TestbedUse::add_to(report::TestbedFigures& figures) const {
  figures["start_wall_s"] = start_wall_s;
  if (started_h) figures["started_h"] = *started_h;
  if (parked_h) figures["parked_h"] = *parked_h;
  if (!handed_over_h) return;
  figures[std::string(report::kHandedOver)] = *handed_over_h;
  figures["failure"] = failure;
}

}  // namespace vbar::testbeds
