#pragma once
// Points of the sweeps: the cases with the same values of all swept keys.

#include <cstddef>
#include <string>
#include <vector>

#include "host_sim/campaign_report/campaign.h"

namespace vbar::campaign_report {

struct SweepPoint {
  std::string name;                 ///< "links.crosslink.loss_probability = 0.05"; empty without a sweep
  std::vector<std::size_t> places;  ///< in Campaign::cases
};

/// Returns the points in the order of their first cases; one point without a sweep.
[[nodiscard]] std::vector<SweepPoint> sweep_points(const Campaign& campaign);

/// Cases of different points have the same seed: they share noise, and are not independent of each other.
[[nodiscard]] bool share_seeds(const Campaign& campaign);

}  // namespace vbar::campaign_report
