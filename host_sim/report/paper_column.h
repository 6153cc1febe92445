#pragma once
// Published figures of a whole experiment, to stand beside runs of it in a comparison.

#include <functional>
#include <optional>
#include <string>

#include "host_sim/report/run_record.h"

namespace vbar::report {

struct PaperColumn {
  struct AtWaypoint {
    std::optional<double> control_error_m, navigation_error_m, navigation_velocity_error_mps;
  };

  std::string name;  ///< "paper, software in the loop"
  /// Returns the figures at a waypoint, empty for one that is not in the paper.
  std::function<AtWaypoint(const WaypointRow&)> at;
  std::optional<MeanAndDeviation> navigation_error_m, navigation_velocity_error_mps;
  double dv_mps = 0.0;
  int maneuvers = 0;
  std::optional<MeanAndDeviation> attitude_error_deg = {};  ///< attitude error of the target
};

}  // namespace vbar::report
