#include "host_sim/mission/mission.h"

#include <algorithm>

namespace vbar::mission {

const Spacecraft* Mission::find_spacecraft(std::string_view spacecraft_name) const {
  const auto found = std::find_if(spacecraft.begin(), spacecraft.end(),
                                  [&](const Spacecraft& candidate) { return candidate.name == spacecraft_name; });
  return found == spacecraft.end() ? nullptr : &*found;
}

const Waypoint* Mission::find_waypoint(int index) const {
  const auto found = std::find_if(waypoints.begin(), waypoints.end(),
                                  [&](const Waypoint& candidate) { return candidate.index == index; });
  return found == waypoints.end() ? nullptr : &*found;
}

std::string_view name_of(FlightTarget target) {
  switch (target) {
    case FlightTarget::kInProcess:
      return "in_process";
    case FlightTarget::kHostProcess:
      return "host_process";
    case FlightTarget::kZynqQemu:
      return "zynq_qemu";
    case FlightTarget::kZynqLinuxQemu:
      return "zynq_linux_qemu";
    case FlightTarget::kBoard:
      return "board";
  }
  return "";
}

std::string_view name_of(FlightLink link) {
  switch (link) {
    case FlightLink::kSerial:
      return "serial";
    case FlightLink::kUdp:
      return "udp";
  }
  return "";
}

std::string_view name_of(NavigationSource source) {
  switch (source) {
    case NavigationSource::kIdeal:
      return "ideal";
    case NavigationSource::kRecorded:
      return "recorded";
  }
  return "";
}

}  // namespace vbar::mission
