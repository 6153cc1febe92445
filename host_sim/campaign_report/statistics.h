#pragma once
// Bounds of a probability of which passed cases of independent ones are known (Clopper and Pearson, 1934).

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/campaign_report/campaign.h"
#include "host_sim/report/plots/plot_axis.h"

namespace vbar::campaign_report {

/// A share with its bounds, all from 0 to 1.
struct PassRate {
  std::size_t passed = 0, of = 0;
  double lower = 0.0, upper = 1.0;

  [[nodiscard]] double share() const { return static_cast<double>(passed) / static_cast<double>(of); }
};

/// Two-sided bounds: each is exceeded with a probability of at most (1 - confidence) / 2. Without cases they are 0
/// and 1. Throws std::invalid_argument if more have passed than there are, or for a confidence outside (0, 1).
[[nodiscard]] PassRate pass_rate(std::size_t passed, std::size_t of, double confidence);

/// The one-sided lower bound, which a claim "at least" needs: exceeded with a probability of at most 1 - confidence.
/// Throws as above.
[[nodiscard]] double one_sided_lower_bound(std::size_t passed, std::size_t of, double confidence);

/// The number of cases, all of them passed, that show a pass rate of at least `rate` (one-sided). Throws
/// std::invalid_argument unless rate and confidence are inside (0, 1).
[[nodiscard]] std::size_t cases_needed(double rate, double confidence);

// Percentiles with bounds that hold for any continuous distribution: order statistics, chosen by the binomial
// distribution (Conover, Practical Nonparametric Statistics, 3rd ed., section 3.2). Where the values are too few for a
// bound it is open, never a number.

/// Places among the sorted values, from 1; none where the bound is open.
struct PercentileRanks {
  std::optional<std::size_t> lower, upper;
};

/// Between the values of these ranks the `share` quantile of the distribution lies with a probability of at least
/// `confidence`, and beyond each with one of at most (1 - confidence) / 2. Both between 0 and 1, exclusive.
[[nodiscard]] PercentileRanks percentile_ranks(std::size_t count, double share, double confidence);

/// The least number of values for which the upper bound is closed.
[[nodiscard]] std::size_t values_needed(double share, double confidence);

struct Percentile {
  double share = 0.0;
  std::optional<double> estimate;  ///< only where the upper bound is closed: else the values do not support it
  std::optional<double> lower, upper;
};

/// Returns the percentile of independent, sorted values with its bounds.
[[nodiscard]] Percentile percentile(const std::vector<double>& sorted, double share, double confidence);

// Whether two quantities of a case go together: Spearman's rank correlation, and Holm's correction where many pairs are
// tested at once.

/// Ranks from 1; equal values share the mean of their ranks.
[[nodiscard]] std::vector<double> ranks(const std::vector<double>& values);

struct RankCorrelation {
  double rho = 0.0;      ///< -1 to 1
  double p_value = 1.0;  ///< two-sided, of independent quantities, by Student's t with n - 2 degrees of freedom
  std::size_t count = 0;
};

/// Returns the p value of a rank correlation of `count` > 2 pairs.
[[nodiscard]] double spearman_p_value(double rho, std::size_t count);

/// Fewer pairs do not support the approximation of the p value.
inline constexpr std::size_t kMinPairs = 10;

/// Returns the rank correlation of the pairs in which both values are finite; empty if these are fewer than kMinPairs,
/// or one quantity is constant. Both vectors have the same size.
[[nodiscard]] std::optional<RankCorrelation> spearman(const std::vector<double>& x, const std::vector<double>& y);

/// p values adjusted for their number (Holm, 1979), in the same order: those below a level are significant with at most
/// that probability of even one false one, whatever their dependence.
[[nodiscard]] std::vector<double> holm(const std::vector<double>& p_values);

// Whether the errors of a filter agree with its claims: normalised squared errors (NEES of the state, NIS of the
// innovations) of many independent cases at one time against the chi-square distribution of their sum (Bar-Shalom, Li
// and Kirubarajan, Estimation with Applications to Tracking and Navigation, 2001, section 5.4). The mean over the time
// of one case is not such a test: its epochs are correlated.

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

// Errors as vectors: circular error probable and its 95 % counterpart in a plane, and the ellipse of the covariance.
// Radii are about the aim, so that a bias counts; neither assumes a Gaussian.

/// An error with components in RTN, of the complete cases that have it.
struct VectorError {
  std::string key;                                  ///< "waypoints.10.control_error": without axis and unit
  std::vector<std::array<double, 3>> errors_rtn_m;  ///< m
};

/// Returns the errors for which results.csv has the three components "<key>_r_m", "<key>_t_m", "<key>_n_m".
[[nodiscard]] std::vector<VectorError> vector_errors(const Campaign& campaign);

/// A plane of RTN by its axes, 0 to 2.
struct Plane {
  const char* name;
  std::size_t first, second;
};
/// Across the track, and the horizontal plane.
inline constexpr std::array kPlanes{Plane{"RN (across the track)", 0, 2}, Plane{"TN (horizontal)", 1, 2}};

struct PlaneMiss {
  Percentile cep_m, r95_m;          ///< radii that half of the cases, 95 % of them, keep to
  std::array<double, 2> mean_m{};   ///< bias
  std::array<double, 2> sigma_m{};  ///< semi-axes of the ellipse of the sample covariance, the larger first
  double angle_rad = 0.0;           ///< angle of the larger semi-axis, from the plane's first axis to its second
};

/// Returns the figures of at least two cases.
[[nodiscard]] PlaneMiss miss_in(const Plane& plane, const VectorError& error, double confidence);

}  // namespace vbar::campaign_report
