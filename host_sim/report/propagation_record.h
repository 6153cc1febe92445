#pragma once
// Record of a propagation without flight software.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "fsw/core/gps_time.h"
#include "fsw/orbit/elements.h"
#include "host_sim/truth/earth/geodetic.h"
#include "host_sim/truth/truth_model.h"

namespace vbar::report {

/// One spacecraft at one sampling time.
struct EphemerisRow {
  fsw::GpsTime time;
  double time_s = 0.0;               ///< since the mission's epoch
  fsw::orbit::CartesianState state;  ///< GCRF
  truth::GeodeticPosition geodetic;  ///< WGS 84
};

struct PropagatedSpacecraft {
  std::string name;
  double first_altitude_m = 0.0;                           ///< above WGS 84, at the start
  double last_altitude_m = 0.0;                            ///< and at the last sampling time
  std::optional<double> semi_major_axis_change_by_drag_m;  ///< over the flight, below 0; nothing without drag
  truth::TruthStatistics statistics;
};

struct PropagationRecord {
  std::string mission;
  bool complete = false;
  std::string incomplete_reason;
  double simulated_s = 0.0;
  double wall_s = 0.0;  ///< wall time of the propagation, files included
  int threads = 1;
  std::vector<std::string> data_notes;  ///< on data that are missing, predicted or used in part
  std::vector<PropagatedSpacecraft> spacecraft;
  truth::TruthStatistics total;
  std::vector<truth::ForceTime> force_times;  ///< summed over spacecraft, so over threads too
};

}  // namespace vbar::report
