#pragma once
// Figures of the cases that the page judges, and how their values are written.

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host_sim/campaign_report/campaign.h"
#include "host_sim/campaign_report/statistics.h"
#include "host_sim/report/plots/svg_plot.h"

namespace vbar::campaign_report {

/// A figure of the complete cases with its limits.
struct Quantity {
  std::string key;
  std::optional<double> max, min;
  std::vector<double> values;  ///< in the order of Campaign::cases; NaN of a case that is not complete or lacks it

  [[nodiscard]] bool has_limit() const { return max || min; }
  /// Returns a positive number beyond a limit; without a limit the value itself: the larger, the worse.
  [[nodiscard]] double badness(double value) const;
};

/// Returns the quantities with pass criteria and, as a campaign may have none, the errors at the last waypoint and
/// delta-v; empty before a case is complete.
[[nodiscard]] std::vector<Quantity> quantities(const Campaign& campaign);

/// The values that there are.
[[nodiscard]] std::vector<double> sorted_values(const Quantity& quantity);

/// Writes a value with its unit, in which the key ends: "waypoints.10.navigation_error_m" of 0.004 is "4.00 mm".
[[nodiscard]] std::string value_text(std::string_view key, double value);

/// "most 20.0 mm", "at least 0.5"; empty without limits.
[[nodiscard]] std::string limits_text(const Quantity& quantity);

/// An axis of such values: "navigation error", in metres.
[[nodiscard]] report::Axis axis_of(std::string_view key);

/// A logarithmic axis shows the values better: all are positive, and the largest is many times the median.
[[nodiscard]] bool is_heavy_tailed(const std::vector<double>& sorted);

// Points of the sweeps: the cases with the same values of all swept keys.

struct SweepPoint {
  std::string name;                 ///< "links.crosslink.loss_probability = 0.05"; empty without a sweep
  std::vector<std::size_t> places;  ///< in Campaign::cases
};

/// Returns the points in the order of their first cases; one point without a sweep.
[[nodiscard]] std::vector<SweepPoint> sweep_points(const Campaign& campaign);

/// Cases of different points have the same seed: they share noise, and are not independent of each other.
[[nodiscard]] bool share_seeds(const Campaign& campaign);

// Figures at selected times: "samples.39.5h.nees" is the NEES 39.5 h after the epoch.

/// Epochs of `name` ("nees" or "nis") in order of time, over the complete cases among `places` that have it. Throws
/// std::runtime_error that names the column, for a negative value and one without its dimension.
[[nodiscard]] std::vector<Epoch> epochs_of(const Campaign& campaign, std::string_view name,
                                           const std::vector<std::size_t>& places);

/// Times of the campaign of which results.csv has no such column, although cases are complete.
[[nodiscard]] std::vector<double> missing_samples(const Campaign& campaign);

// Dependence of the figures of the cases on the swept and dispersed quantities.

/// A swept or dispersed quantity as a number: a key, or a component of one that is a vector ("key[1]"); true and false
/// are 1 and 0.
struct Driver {
  std::string name;
  std::vector<double> values;  ///< in the order of Campaign::cases
};

/// Returns the quantities that are numbers in all cases and not constant; `others` gets the names of the rest.
[[nodiscard]] std::vector<Driver> drivers(const Campaign& campaign, std::vector<std::string>& others);

/// A figure that may depend on them. "not passed" is 1 of every judged case that has not passed, failed ones included.
struct Response {
  std::string name;
  std::vector<double> values;  ///< NaN of cases that are left out
  const Quantity* quantity = nullptr;
};

[[nodiscard]] std::vector<Response> responses(const Campaign& campaign, const std::vector<Quantity>& quantities);

struct Dependence {
  const Driver* driver = nullptr;
  const Response* response = nullptr;
  RankCorrelation correlation;
  double adjusted_p = 1.0;  ///< after Holm, over all dependences

  [[nodiscard]] bool is_significant() const { return adjusted_p < 0.05; }
};

/// Returns every pair with a rank correlation, the strongest first.
[[nodiscard]] std::vector<Dependence> dependences(const std::vector<Driver>& drivers,
                                                  const std::vector<Response>& responses);

}  // namespace vbar::campaign_report
