#include "host_sim/campaign_report/statistics.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>

#include <boost/math/distributions/binomial.hpp>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/students_t.hpp>

#include "host_sim/report/statistics.h"

namespace vbar::campaign_report {

namespace {

using Binomial = boost::math::binomial_distribution<double>;

void require_probability(double p, const char* name) {
  if (!(p > 0.0 && p < 1.0)) throw std::invalid_argument(std::string(name) + " is not between 0 and 1");
}

}  // namespace

PassRate pass_rate(std::size_t passed, std::size_t of, double confidence) {
  const double tail = 0.5 * (1.0 - confidence);
  PassRate rate{passed, of, one_sided_lower_bound(passed, of, 1.0 - tail), 1.0};
  if (passed < of) {
    rate.upper = Binomial::find_upper_bound_on_p(static_cast<double>(of), static_cast<double>(passed), tail,
                                                 Binomial::clopper_pearson_exact_interval);
  }
  return rate;
}

double one_sided_lower_bound(std::size_t passed, std::size_t of, double confidence) {
  require_probability(confidence, "confidence");
  if (passed > of) throw std::invalid_argument("more cases have passed than there are");
  if (passed == 0) return 0.0;
  return Binomial::find_lower_bound_on_p(static_cast<double>(of), static_cast<double>(passed), 1.0 - confidence,
                                         Binomial::clopper_pearson_exact_interval);
}

// n cases of probability `rate` all pass with a probability of rate^n, which must not exceed 1 - confidence.
std::size_t cases_needed(double rate, double confidence) {
  require_probability(rate, "pass rate");
  require_probability(confidence, "confidence");
  return static_cast<std::size_t>(std::ceil(std::log1p(-confidence) / std::log(rate) - 1e-9));
}

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

std::vector<VectorError> vector_errors(const Campaign& campaign) {
  constexpr std::string_view kFirst = "error_r_m", kAxis = "_r_m";
  std::vector<VectorError> found;
  for (const Figure& radial : campaign.figures) {
    if (!radial.key.ends_with(kFirst)) continue;
    VectorError error{radial.key.substr(0, radial.key.size() - kAxis.size()), {}};
    const Figure* const along = campaign.figure(error.key + "_t_m");
    const Figure* const normal = campaign.figure(error.key + "_n_m");
    if (along == nullptr || normal == nullptr) continue;
    for (std::size_t k = 0; k < campaign.cases.size(); ++k) {
      const std::array<double, 3> rtn{radial.values[k], along->values[k], normal->values[k]};
      const bool is_whole = std::ranges::all_of(rtn, [](double v) { return std::isfinite(v); });
      if (campaign.cases[k].is_complete() && is_whole) error.errors_rtn_m.push_back(rtn);
    }
    if (error.errors_rtn_m.size() >= 2) found.push_back(std::move(error));
  }
  return found;
}

PlaneMiss miss_in(const Plane& plane, const VectorError& error, double confidence) {
  const auto count = static_cast<double>(error.errors_rtn_m.size());
  PlaneMiss miss;
  std::vector<double> radii;
  for (const auto& rtn : error.errors_rtn_m) {
    radii.push_back(std::hypot(rtn[plane.first], rtn[plane.second]));
    miss.mean_m[0] += rtn[plane.first] / count;
    miss.mean_m[1] += rtn[plane.second] / count;
  }
  std::ranges::sort(radii);
  miss.cep_m = percentile(radii, 0.5, confidence);
  miss.r95_m = percentile(radii, 0.95, confidence);
  double xx = 0.0, xy = 0.0, yy = 0.0;
  for (const auto& rtn : error.errors_rtn_m) {
    const double x = rtn[plane.first] - miss.mean_m[0], y = rtn[plane.second] - miss.mean_m[1];
    xx += x * x / (count - 1.0);
    xy += x * y / (count - 1.0);
    yy += y * y / (count - 1.0);
  }
  // Eigenvalues of a symmetric 2x2 matrix.
  const double half_sum = 0.5 * (xx + yy), radius = std::hypot(0.5 * (xx - yy), xy);
  miss.sigma_m = {std::sqrt(half_sum + radius), std::sqrt(std::max(0.0, half_sum - radius))};
  miss.angle_rad = 0.5 * std::atan2(2.0 * xy, xx - yy);
  return miss;
}

}  // namespace vbar::campaign_report
