#pragma once
// One function a section of a mission file: takes the document, checks, fills its part of the mission. In this order,
// because later ones look at what earlier ones filled. All throw MissionError.

#include "host_sim/mission/mission.h"
#include "host_sim/mission/table_reader.h"

namespace vbar::mission {

inline constexpr double kHour_s = 3600.0;
inline constexpr double kLongestMission_h = 2000.0;  ///< below 2^53 ns, so that hours convert to exact nanoseconds

void read_general(const TableReader& document, Mission& mission);          // [mission]
void read_truth(const TableReader& document, Mission& mission);            // [truth]
void read_waypoints(const TableReader& document, Mission& mission);        // [[waypoint]]
void read_spacecraft(const TableReader& document, Mission& mission);       // [[spacecraft]]
void read_guidance(const TableReader& document, Mission& mission);         // [guidance]
void read_gnss_navigation(const TableReader& document, Mission& mission);  // [gnss_navigation]
void read_angles_only(const TableReader& document, Mission& mission);      // [angles_only]
void read_pose(const TableReader& document, Mission& mission);             // [pose]
void read_constellation(const TableReader& document, Mission& mission);    // [constellation]
void read_burns(const TableReader& document, Mission& mission);            // [[burn]]
void read_clock(const TableReader& document, Mission& mission);            // [clock]
void read_links(const TableReader& document, Mission& mission);            // [links.*]
void read_lcm(const TableReader& document, Mission& mission);              // [lcm]
void read_record(const TableReader& document, Mission& mission);           // [record]

}  // namespace vbar::mission
