#pragma once
// Dependence of the figures of the cases on the swept and dispersed quantities.

#include <string>
#include <vector>

#include "host_sim/campaign_report/quantity.h"
#include "host_sim/campaign_report/rank_correlation.h"

namespace vbar::campaign_report {

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
