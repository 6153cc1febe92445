#include "host_sim/verification/rank_tests.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <boost/math/distributions/hypergeometric.hpp>
#include <boost/math/distributions/normal.hpp>

namespace vbar::verification {

namespace {

constexpr std::size_t kMaxExact = 8;

/// Probability of a statistic U of at least `u`, two samples of m and n values of one continuous distribution. The
/// number of arrangements with each U: those whose largest value is of the first sample, and of the second one.
double exact_tail(std::size_t m, std::size_t n, double u) {
  std::vector<std::vector<std::vector<double>>> counts(m + 1, std::vector<std::vector<double>>(n + 1));
  for (std::size_t i = 0; i <= m; ++i) {
    for (std::size_t j = 0; j <= n; ++j) {
      std::vector<double>& here = counts[i][j];
      here.assign(i * j + 1, 0.0);
      if (i == 0 || j == 0) {
        here[0] = 1.0;
        continue;
      }
      for (std::size_t k = 0; k < here.size(); ++k) {
        if (k >= j && k - j < counts[i - 1][j].size()) here[k] += counts[i - 1][j][k - j];
        if (k < counts[i][j - 1].size()) here[k] += counts[i][j - 1][k];
      }
    }
  }
  double tail = 0.0, all = 0.0;
  for (std::size_t k = 0; k < counts[m][n].size(); ++k) {
    all += counts[m][n][k];
    if (static_cast<double>(k) >= u) tail += counts[m][n][k];
  }
  return tail / all;
}

}  // namespace

double mann_whitney_p(const std::vector<double>& earlier, const std::vector<double>& later) {
  if (earlier.empty() || later.empty()) return 1.0;
  double u = 0.0;  // pairs in which the later value is larger; half of those that are equal
  std::map<double, double> equal;
  for (const double x : earlier) ++equal[x];
  for (const double y : later) {
    ++equal[y];
    for (const double x : earlier) u += y > x ? 1.0 : (y == x ? 0.5 : 0.0);
  }
  const bool has_ties = equal.size() < earlier.size() + later.size();
  if (!has_ties && std::min(earlier.size(), later.size()) <= kMaxExact)
    return exact_tail(later.size(), earlier.size(), u);
  const auto m = static_cast<double>(later.size()), n = static_cast<double>(earlier.size());
  double ties = 0.0;
  for (const auto& [value, count] : equal) ties += count * count * count - count;
  const double variance = m * n / 12.0 * (m + n + 1.0 - ties / ((m + n) * (m + n - 1.0)));
  if (!(variance > 0.0)) return 1.0;
  const boost::math::normal distribution;
  return boost::math::cdf(boost::math::complement(distribution, (u - 0.5 * m * n - 0.5) / std::sqrt(variance)));
}

double fisher_p(std::size_t earlier_met, std::size_t earlier, std::size_t later_met, std::size_t later) {
  const auto met = static_cast<unsigned>(earlier_met + later_met);
  if (earlier == 0 || later == 0) return 1.0;
  const boost::math::hypergeometric distribution(met, static_cast<unsigned>(later),
                                                 static_cast<unsigned>(earlier + later));
  return std::min(1.0, boost::math::cdf(distribution, static_cast<unsigned>(later_met)));
}

}  // namespace vbar::verification
