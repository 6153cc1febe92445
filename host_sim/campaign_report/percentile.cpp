#include "host_sim/campaign_report/percentile.h"

#include <algorithm>
#include <cmath>

#include <boost/math/distributions/binomial.hpp>

#include "host_sim/report/statistics.h"

namespace vbar::campaign_report {
namespace {

/// The least k below `count` at which the probability of at most k values below the quantile satisfies `reached`; else
/// `count`. That probability increases with k.
template <class Reached>
std::size_t first_rank(std::size_t count, double share, const Reached& reached) {
  const boost::math::binomial_distribution<double> below(static_cast<double>(count), share);
  std::size_t first = 0, end = count;
  while (first < end) {
    const std::size_t middle = first + (end - first) / 2;
    if (reached(boost::math::cdf(below, static_cast<double>(middle)))) {
      end = middle;
    } else {
      first = middle + 1;
    }
  }
  return first;
}

}  // namespace

// The r-th smallest value lies at or below the quantile if at least r values do.
PercentileRanks percentile_ranks(std::size_t count, double share, double confidence) {
  const double tail = 0.5 * (1.0 - confidence);
  const std::size_t lower = first_rank(count, share, [tail](double p) { return p > tail; });
  const std::size_t upper = first_rank(count, share, [tail](double p) { return p >= 1.0 - tail; });
  PercentileRanks ranks;
  if (lower > 0) ranks.lower = lower;
  if (upper < count) ranks.upper = upper + 1;
  return ranks;
}

// The largest of n values lies below the quantile with a probability of share^n.
std::size_t values_needed(double share, double confidence) {
  return static_cast<std::size_t>(std::ceil(std::log(0.5 * (1.0 - confidence)) / std::log(share) - 1e-9));
}

Percentile percentile(const std::vector<double>& sorted, double share, double confidence) {
  const PercentileRanks ranks = percentile_ranks(sorted.size(), share, confidence);
  Percentile result{.share = share, .estimate = {}, .lower = {}, .upper = {}};
  if (ranks.lower) result.lower = sorted[*ranks.lower - 1];
  if (ranks.upper) {
    result.upper = sorted[*ranks.upper - 1];
    result.estimate = report::quantile(sorted, share);
  }
  return result;
}

}  // namespace vbar::campaign_report
