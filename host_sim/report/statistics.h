#pragma once
// Mean, standard deviation and quantiles of what a run counted.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/report/plots/html_page.h"
#include "host_sim/report/plots/plot_axis.h"
#include "host_sim/report/run_record.h"
#include "host_sim/report/summary.h"

namespace vbar::report {

/// Returns mean and standard deviation of at least one value.
[[nodiscard]] inline MeanAndDeviation statistics(const std::vector<double>& values) {
  double sum = 0.0, squares = 0.0;
  for (const double v : values) sum += v;
  const double mean = sum / static_cast<double>(values.size());
  for (const double v : values) squares += (v - mean) * (v - mean);
  return {mean, std::sqrt(squares / static_cast<double>(values.size()))};
}

/// Returns the mean, empty if there is no value.
[[nodiscard]] inline std::optional<double> mean_of(const std::vector<double>& values) {
  return values.empty() ? std::nullopt : std::optional(statistics(values).mean);
}

[[nodiscard]] inline std::optional<MeanAndDeviation> statistics_of(const std::vector<double>& values) {
  return values.empty() ? std::nullopt : std::optional(statistics(values));
}

/// Returns the smallest of at least one sorted value that is not below that share of them.
[[nodiscard]] inline double quantile(const std::vector<double>& sorted, double share) {
  const auto place = static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size())));
  return sorted[std::clamp<std::size_t>(place, 1, sorted.size()) - 1];
}

// Whether a filter's claims agree with its errors: means of chi-square distributed figures (NEES, NIS) against the band
// that contains the mean of this number of independent samples with a probability of 95 %.

/// The central 95 % of chi-square with `degrees` (> 0) degrees of freedom.
[[nodiscard]] Range chi_square_band(double degrees);

/// Returns the band of the mean of `samples` (> 0) independent draws.
[[nodiscard]] Range mean_band(double degrees, std::size_t samples);

/// The mean beside its expectation and band, set off if it is outside; a dash without a mean, no band without samples.
[[nodiscard]] Fact consistency_fact(const std::string& name, const std::optional<double>& mean, double degrees,
                                    std::size_t samples);

/// Explanation of the bands for the reader, as HTML.
inline constexpr const char* kBandNote =
    "<p class=\"note\">95 % bands of NEES and NIS are those of a mean of independent chi-square samples. Successive "
    "errors of a filter are correlated, so that the mean of a consistent filter leaves its band more often.</p>\n";

// Estimates beside the truth of their times.

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

// True distance from the servicer to the target over a run, between flight steps too.

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

// Burns against a thrust that the mission states. Burns are flown as impulses; this only reports those that the
// thruster could not deliver.

/// Fills the figures of record.summary.thrust, which holds thrust and mass: a burn of the flight software lasts mass
/// times delta-v over thrust, and does not fit if the next one begins earlier.
void summarise_thrust(const RunRecord& record, Summary& summary);

/// "thrust: 2 of 306 burns would last longer than the time to the next burn at 0.02 N and 30 kg; ..."; empty if the
/// mission states no thrust or nothing was burnt.
[[nodiscard]] std::string thrust_line(const Summary& summary);

}  // namespace vbar::report
