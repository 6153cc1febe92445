#pragma once
// Whether the errors of a filter agree with its claims: normalised squared errors (NEES of the state, NIS of the
// innovations) of many independent cases at one time against the chi-square distribution of their sum (Bar-Shalom, Li
// and Kirubarajan, Estimation with Applications to Tracking and Navigation, 2001, section 5.4). The mean over the time
// of one case is not such a test: its epochs are correlated.

#include <cstddef>
#include <vector>

#include "host_sim/report/plot_axis.h"

namespace vbar::campaign_report {

/// One figure of one case at one epoch.
struct NormalisedError {
  double value = 0.0;      ///< NEES or NIS
  double dimension = 0.0;  ///< expected value of a consistent filter, > 0
};

/// One epoch over its cases, of which there is at least one.
struct Epoch {
  double time_h = 0.0;
  std::size_t cases = 0;
  double mean = 0.0;            ///< ANEES, or mean NIS
  double mean_dimension = 0.0;  ///< expected value of `mean`
  report::Range band;           ///< 95 % of `mean` of a consistent filter
  double p_value = 1.0;         ///< two-sided, of a consistent filter

  [[nodiscard]] bool is_above() const { return mean > band.high; }
  [[nodiscard]] bool is_below() const { return mean < band.low; }
};

[[nodiscard]] Epoch epoch_of(double time_h, const std::vector<NormalisedError>& errors);

/// The epochs of a filter together.
struct Consistency {
  std::size_t epochs = 0, above = 0, below = 0;
  double p_value = 1.0;      ///< the smallest, corrected for their number: holds however the epochs are correlated
  bool is_rejected = false;  ///< a consistent filter would have such an epoch in less than 5 % of the campaigns

  [[nodiscard]] double share_inside() const {
    return 1.0 - static_cast<double>(above + below) / static_cast<double>(epochs);
  }
};

[[nodiscard]] Consistency consistency_of(const std::vector<Epoch>& epochs);

}  // namespace vbar::campaign_report
