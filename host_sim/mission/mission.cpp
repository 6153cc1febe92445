#include "host_sim/mission/mission.h"

#include <algorithm>
#include <charconv>
#include <string_view>
#include <system_error>

#include <arpa/inet.h>

#include "host_sim/mission/table_reader.h"

namespace vbar::mission {

const std::string& Spacecraft::observes() const {
  static const std::string nobody;
  const auto found =
      std::ranges::find_if(sensors, [](const Sensor& sensor) { return !sensor.settings->observed.empty(); });
  return found == sensors.end() ? nobody : found->settings->observed;
}

bool Mission::flies() const {
  return std::any_of(spacecraft.begin(), spacecraft.end(),
                     [](const Spacecraft& candidate) { return candidate.flight_computer.has_value(); });
}

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
  return name_in(kFlightTargets, target);
}
std::string_view name_of(FlightLink link) {
  return name_in(kFlightLinks, link);
}

std::string_view name_of(FaultKind kind) {
  return name_in(kFaultKinds, kind);
}

vbar::waypoint_table waypoint_table_of(const Mission& mission) {
  vbar::waypoint_table table{};
  table.reference_semi_major_axis_m = mission.guidance.reference_semi_major_axis_m;
  for (const Waypoint& waypoint : mission.waypoints) {
    vbar::waypoint& entry = table.waypoints[table.count++];
    entry.index = waypoint.index;
    entry.control_mode = static_cast<std::int8_t>(waypoint.solver);
    entry.gps_time_ns = waypoint.time.ns;
    std::copy(waypoint.a_roe_m.begin(), waypoint.a_roe_m.end(), entry.a_roe_m);
    entry.keep_out_radius_m = waypoint.keep_out_radius_m.value_or(0.0);
  }
  return table;
}

vbar::mode_command mode_command_of(const Mission& mission) {
  vbar::mode_command command{};
  command.mode = static_cast<std::int8_t>(mission.guidance.mode);
  return command;
}

UdpAddress read_udp_address(const TableReader& section, const std::string& key) {
  UdpAddress address;
  const std::string text = section.text(key, "");
  if (text.empty()) return address;
  const std::size_t colon = text.rfind(':');
  const std::string_view digits = colon == std::string::npos ? "" : std::string_view(text).substr(colon + 1);
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), address.port);
  address.host = text.substr(0, colon);
  in_addr ignored{};
  if (error != std::errc{} || end != digits.data() + digits.size() || address.port == 0 ||
      ::inet_pton(AF_INET, address.host.c_str(), &ignored) != 1)
    section.refuse_value(key, "an IPv4 address and a port, \"127.0.0.1:5005\"");
  return address;
}

}  // namespace vbar::mission
