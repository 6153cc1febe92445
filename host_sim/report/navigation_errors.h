#pragma once
// Estimates beside the truth of their times.

#include <optional>
#include <vector>

#include "host_sim/report/run_record.h"

namespace vbar::report {

/// One valid estimate less the truth, target with respect to servicer, servicer's RTN.
struct NavigationError {
  double time_s = 0.0;  ///< since the mission's epoch
  Triple position_rtn{}, velocity_rtn{};
  Sextuple sigma_rtn{};  ///< as navigation claims
};

/// Returns the errors at all steps that have a valid estimate and a truth, in order.
[[nodiscard]] std::vector<NavigationError> navigation_errors(const RunRecord& record);

/// Time since the mission's epoch of the first step whose estimate is by fixed ambiguities.
[[nodiscard]] std::optional<double> first_fix(const RunRecord& record);

}  // namespace vbar::report
