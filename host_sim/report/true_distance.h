#pragma once
// True distance from the servicer to the target over a run, between flight steps too.

#include <functional>
#include <optional>

#include "host_sim/report/run_record.h"

namespace vbar::report {

struct TrueDistance {
  double time_s = 0.0;  ///< since the mission's epoch
  double distance_m = 0.0;
};

/// Key of the minimum in the summary, which a [[limit]] of a mission can name.
inline constexpr const char* kMinDistanceKey = "min_distance_m";

/// Visits in order of time the distance of the truth at each flight step and, where steps are at most two minutes
/// apart, at seven instants between them, by the cubic through the true relative positions and velocities at both ends.
/// Between steps dt apart a burn of size dv disturbs it by at most dv dt / 8.
void for_each_distance(const RunRecord& record, const std::function<void(const TrueDistance&)>& visit);

/// Returns the smallest distance, empty without a truth.
[[nodiscard]] std::optional<TrueDistance> min_distance(const RunRecord& record);

}  // namespace vbar::report
