#include "host_sim/campaign_report/rank_correlation.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <boost/math/distributions/students_t.hpp>

namespace vbar::campaign_report {
namespace {

std::vector<std::size_t> order_of(const std::vector<double>& values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t k) { return values[k]; });
  return order;
}

/// Pearson's correlation; not finite if one is constant.
double correlation(const std::vector<double>& x, const std::vector<double>& y) {
  const auto count = static_cast<double>(x.size());
  const double mean_x = std::accumulate(x.begin(), x.end(), 0.0) / count;
  const double mean_y = std::accumulate(y.begin(), y.end(), 0.0) / count;
  double xx = 0.0, yy = 0.0, xy = 0.0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    xx += (x[k] - mean_x) * (x[k] - mean_x);
    yy += (y[k] - mean_y) * (y[k] - mean_y);
    xy += (x[k] - mean_x) * (y[k] - mean_y);
  }
  return xy / std::sqrt(xx * yy);
}

}  // namespace

std::vector<double> ranks(const std::vector<double>& values) {
  const std::vector<std::size_t> order = order_of(values);
  std::vector<double> result(values.size());
  for (std::size_t first = 0; first < order.size();) {
    std::size_t end = first + 1;
    while (end < order.size() && values[order[end]] == values[order[first]]) ++end;
    for (std::size_t k = first; k < end; ++k) result[order[k]] = 0.5 * static_cast<double>(first + 1 + end);
    first = end;
  }
  return result;
}

double spearman_p_value(double rho, std::size_t count) {
  const auto degrees = static_cast<double>(count - 2);
  const double left = 1.0 - rho * rho;
  if (!(left > 0.0)) return 0.0;
  const boost::math::students_t distribution(degrees);
  return 2.0 * boost::math::cdf(boost::math::complement(distribution, std::abs(rho) * std::sqrt(degrees / left)));
}

std::optional<RankCorrelation> spearman(const std::vector<double>& x, const std::vector<double>& y) {
  std::vector<double> paired_x, paired_y;
  for (std::size_t k = 0; k < x.size(); ++k) {
    if (!std::isfinite(x[k]) || !std::isfinite(y[k])) continue;
    paired_x.push_back(x[k]);
    paired_y.push_back(y[k]);
  }
  if (paired_x.size() < kMinPairs) return std::nullopt;
  const double rho = std::clamp(correlation(ranks(paired_x), ranks(paired_y)), -1.0, 1.0);
  if (!std::isfinite(rho)) return std::nullopt;
  return RankCorrelation{rho, spearman_p_value(rho, paired_x.size()), paired_x.size()};
}

std::vector<double> holm(const std::vector<double>& p_values) {
  const std::vector<std::size_t> order = order_of(p_values);
  std::vector<double> adjusted(p_values.size());
  double largest = 0.0;
  for (std::size_t k = 0; k < order.size(); ++k) {
    largest = std::max(largest, std::min(1.0, static_cast<double>(order.size() - k) * p_values[order[k]]));
    adjusted[order[k]] = largest;
  }
  return adjusted;
}

}  // namespace vbar::campaign_report
