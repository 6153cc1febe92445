#pragma once
// One function for each section of a mission file: takes the document, checks, fills its part of the mission. All throw
// MissionError.

#include <optional>
#include <string>
#include <string_view>

#include "fsw/orbit/rtn.h"
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
void read_telemetry(const TableReader& document, Mission& mission);                                // [telemetry]
void read_record(const TableReader& document, Mission& mission);                                   // [record]
void read_limits(const TableReader& document, Mission& mission);                                   // [[limit]]

/// Reads a table of [[limit]] of a mission, or of [[pass]] of a campaign.
Limit read_limit(const TableReader& section);

/// Reads [spacecraft.sensors.*]: kinds in the order of the installation, the sensors of a kind in alphabetical order.
std::vector<Sensor> read_sensors(const TableReader& sensors, const SensorContext& context);
void check_sensors(const TableReader& sensors, const Spacecraft& spacecraft, const Mission& mission,
                   const Installation& installation);

/// Checks the testbeds against the complete mission.
void check_testbeds(const TableReader& document, const Mission& mission, const Installation& installation);

/// Reads `distribution` and its parameters.
engine::LatencyDistribution read_latency(const TableReader& section);

// One [[spacecraft]] section for many spacecraft: `count` of them, each offset by `spacing` from the previous one.
//
//   [[spacecraft]]
//   name = "swarm"                     swarm_01, swarm_02, ... swarm_50
//   count = 50
//   spacing = { raan_deg = 7.2, mean_argument_of_latitude_deg = 136.8, mass_kg = 0.5 }
//   [spacecraft.elements]              of the first one
//   ...

class SpacecraftGroup {
 public:
  /// Reads `name`, `count` and `spacing` of a [[spacecraft]] section, which must outlive the group. Throws
  /// MissionError.
  explicit SpacecraftGroup(const TableReader& section);

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] int count() const { return count_; }

  /// Returns the name of a member: `<name>_<member>`, counted from 1 with as many digits as the last has; the name
  /// alone without a `count`.
  [[nodiscard]] std::string member_name(int member) const;

  /// Reads a number as section.number() does, plus `member` (0, 1, ...) times the spacing of that key. The sum must lie
  /// in the range too.
  [[nodiscard]] double number(const TableReader& section, int member, std::string_view key, Range range,
                              std::optional<double> default_value = std::nullopt) const;

  /// Returns an angle in degrees as number() does; the sum is wrapped to -180 ... 180.
  [[nodiscard]] double angle_deg(const TableReader& section, int member, std::string_view key) const;

 private:
  [[nodiscard]] double shift(int member, std::string_view key) const;

  std::string name_;
  bool counted_;
  int count_;
  TableReader spacing_;
};

// Waypoints that are stated as position and velocity in RTN, converted to the mean relative orbital elements that the
// flight software flies to.

/// Returns the state of the target in the servicer's RTN that a waypoint states, if it does. Throws MissionError for an
/// invalid one, and for one that states elements too.
[[nodiscard]] std::optional<fsw::orbit::RelativeState> target_in_rtn(const TableReader& waypoint);

/// Sets a_roe_m of each waypoint that states RTN: the target, which does not manoeuvre, is where mean elements and J2
/// bring it by that time, and the servicer stands so that the target has that position and velocity in its RTN. Throws
/// MissionError that names the waypoint, if the target's orbit is that of a file or does not exist.
void place_rtn_waypoints(const TableReader& document, Mission& mission);

}  // namespace vbar::mission
