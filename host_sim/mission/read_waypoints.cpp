#include "host_sim/mission/names.h"
#include "host_sim/mission/read_sections.h"

namespace vbar::mission {
namespace {

constexpr double kLargestARoe_m = 1e6;  // limit of the flight software

Waypoint read_waypoint(const TableReader& section, const Mission& mission) {
  Waypoint waypoint;
  waypoint.index = static_cast<int>(section.integer("index", 0, 9999));
  waypoint.time = mission.epoch + section.span("time_h", kHour_s, from_to(0.0, kLongestMission_h));
  const auto a_roe_m = section.six_numbers("a_roe_m", from_to(-kLargestARoe_m, kLargestARoe_m));
  waypoint.a_roe_m = Eigen::Map<const fsw::Vector6>(a_roe_m.data());
  waypoint.solver = section.choice<Solver>("solver", kSolvers, Waypoint{}.solver);
  if (section.has("keep_out_radius_m"))
    waypoint.keep_out_radius_m = section.number("keep_out_radius_m", from_to(0.0, 1e5));
  section.finish();
  return waypoint;
}

}  // namespace

void read_waypoints(const TableReader& document, Mission& mission) {
  std::vector<TableReader> sections = document.tables("waypoint");
  if (sections.size() > kMaxWaypoints)
    document.refuse("waypoint", std::to_string(sections.size()) + " waypoints",
                    "at most " + std::to_string(kMaxWaypoints));
  for (TableReader& section : sections) {
    const Waypoint waypoint = read_waypoint(section, mission);
    section.rename("waypoint." + std::to_string(waypoint.index));
    if (mission.find_waypoint(waypoint.index) != nullptr)
      section.refuse("index", "a second waypoint " + std::to_string(waypoint.index), "an index used once");
    if (!mission.waypoints.empty() && waypoint.time <= mission.waypoints.back().time) {
      const Waypoint& before = mission.waypoints.back();
      section.refuse_value(
          "time_h", "a time after that of waypoint " + std::to_string(before.index) + ", which stands before it");
    }
    mission.waypoints.push_back(waypoint);
  }
}

}  // namespace vbar::mission
