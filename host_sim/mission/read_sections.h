#pragma once
// One function for each section of a mission file: takes the document, checks, fills its part of the mission. All throw
// MissionError.

#include "host_sim/mission/mission.h"
#include "host_sim/mission/sensor_reader.h"
#include "host_sim/mission/table_reader.h"

namespace vbar::mission {

inline constexpr double kHour_s = 3600.0;
inline constexpr double kLongestMission_h = 2000.0;  ///< below 2^53 ns, so that hours convert to exact nanoseconds

void read_general(const TableReader& document, Mission& mission);                                     // [mission]
void read_truth(const TableReader& document, Mission& mission, const Installation& installation);     // [truth]
void read_testbeds(const TableReader& document, Mission& mission, const Installation& installation);  // [testbed.*]
void read_waypoints(const TableReader& document, Mission& mission);                                   // [[waypoint]]
void read_spacecraft(const TableReader& document, Mission& mission,
                     const Installation& installation);               // [[spacecraft]]
void read_guidance(const TableReader& document, Mission& mission);    // [guidance]
void read_safety(const TableReader& document, Mission& mission);      // [safety]
void read_navigation(const TableReader& document, Mission& mission);  // [navigation], after its tables by kinds
void read_shared(const TableReader& document, Mission& mission,
                 const Installation& installation);  // by the kinds of sensors: [navigation.*], [links.crosslink]
void read_burns(const TableReader& document, Mission& mission);                                    // [[burn]]
void read_faults(const TableReader& document, Mission& mission);                                   // [[fault]]
void read_clock(const TableReader& document, Mission& mission, const Installation& installation);  // [clock]
void read_links(const TableReader& document, Mission& mission);                                    // [links.board]
void read_lcm(const TableReader& document, Mission& mission);                                      // [lcm]
void read_record(const TableReader& document, Mission& mission);                                   // [record]
void read_limits(const TableReader& document, Mission& mission);                                   // [[limit]]

/// Reads a table of [[limit]] of a mission, or of [[pass]] of a campaign.
Limit read_limit(const TableReader& section);

/// Reads [spacecraft.sensors.*]: kinds in the order of the installation, the sensors of a kind in alphabetical order.
std::vector<Sensor> read_sensors(const TableReader& sensors, const SensorContext& context);
void check_sensors(const TableReader& sensors, const Spacecraft& spacecraft, const Mission& mission,
                   const Installation& installation);

/// Reads `distribution` and its parameters.
engine::LatencyDistribution read_latency(const TableReader& section);

}  // namespace vbar::mission
