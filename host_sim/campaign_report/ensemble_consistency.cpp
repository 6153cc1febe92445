#include "host_sim/campaign_report/ensemble_consistency.h"

#include <algorithm>

#include <boost/math/distributions/chi_squared.hpp>

#include "host_sim/campaign_report/rank_correlation.h"
#include "host_sim/report/consistency.h"

namespace vbar::campaign_report {

Epoch epoch_of(double time_h, const std::vector<NormalisedError>& errors) {
  double sum = 0.0, degrees = 0.0;
  for (const NormalisedError& error : errors) {
    sum += error.value;
    degrees += error.dimension;
  }
  const auto cases = static_cast<double>(errors.size());
  const report::Range band = report::chi_square_band(degrees);
  const boost::math::chi_squared distribution(degrees);
  const double smaller_tail =
      std::min(boost::math::cdf(distribution, sum), boost::math::cdf(boost::math::complement(distribution, sum)));
  return {.time_h = time_h,
          .cases = errors.size(),
          .mean = sum / cases,
          .mean_dimension = degrees / cases,
          .band = {band.low / cases, band.high / cases},
          .p_value = std::min(1.0, 2.0 * smaller_tail)};
}

Consistency consistency_of(const std::vector<Epoch>& epochs) {
  constexpr double kLevel = 0.05;
  Consistency result{.epochs = epochs.size()};
  std::vector<double> p_values;
  for (const Epoch& epoch : epochs) {
    result.above += epoch.is_above() ? 1 : 0;
    result.below += epoch.is_below() ? 1 : 0;
    p_values.push_back(epoch.p_value);
  }
  for (const double p : holm(p_values)) result.p_value = std::min(result.p_value, p);
  result.is_rejected = result.p_value < kLevel;
  return result;
}

}  // namespace vbar::campaign_report
