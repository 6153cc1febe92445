#include "host_sim/verification/compare.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <boost/math/distributions/hypergeometric.hpp>
#include <boost/math/distributions/normal.hpp>
#include <fmt/format.h>

#include "host_sim/campaign_report/quantity.h"
#include "host_sim/campaign_report/statistics.h"
#include "host_sim/report/statistics.h"

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

namespace {

/// A value for each seed, the larger the worse: that of its worst case, as the cases of one seed share their noise and
/// are not independent of each other.
std::vector<double> badness_of(const Json& row, const Json& quantity) {
  const auto cases_per_seed = row["cases_per_seed"].get<std::size_t>();
  const double sign = is_smaller_worse(quantity) ? -1.0 : 1.0;
  std::vector<double> worst;
  for (std::size_t k = 0; k < quantity["values"].size(); ++k) {
    const Json& value = quantity["values"][k];
    const double badness = value.is_number() ? sign * value.get<double>() : value_or_lost(value);
    if (k % cases_per_seed == 0) worst.push_back(badness);
    worst.back() = std::max(worst.back(), badness);
  }
  return worst;
}

double median_of(std::vector<double> badness, const Json& quantity) {
  std::ranges::sort(badness);
  return (is_smaller_worse(quantity) ? -1.0 : 1.0) * report::quantile(badness, 0.5);
}

void compare_quantities(const Json& earlier, const Json& later, std::vector<Worsening>& all) {
  for (const Json& before : earlier["quantities"]) {
    const std::string key = before["key"].get<std::string>();
    const Json* const after = quantity_of(later, key);
    if (after == nullptr || (*after)["worse"] != before["worse"]) continue;
    const std::vector<double> a = badness_of(earlier, before), b = badness_of(later, *after);
    if (a.empty() || b.empty()) continue;
    all.push_back({later["name"].get<std::string>(), key, median_of(a, before), median_of(b, before), a.size(),
                   b.size(), mann_whitney_p(a, b)});
  }
}

/// Of rows without a sweep, whose cases are independent.
void compare_shares(const Json& earlier, const Json& later, std::vector<Worsening>& all) {
  if (earlier["cases_per_seed"] != 1 || later["cases_per_seed"] != 1) return;
  const auto count = [](const Json& row, const char* key) { return row["achieved"][key].get<std::size_t>(); };
  if (count(earlier, "of") == 0 || count(later, "of") == 0) return;
  const auto share = [&](const Json& row) {
    return static_cast<double>(count(row, "count")) / static_cast<double>(count(row, "of"));
  };
  all.push_back({later["name"].get<std::string>(), "share of achieved cases", share(earlier), share(later),
                 count(earlier, "of"), count(later, "of"),
                 fisher_p(count(earlier, "count"), count(earlier, "of"), count(later, "count"), count(later, "of"))});
}

const Json* row_named(const Json& verification, const Json& name) {
  for (const Json& row : verification["rows"])
    if (row["name"] == name) return &row;
  return nullptr;
}

std::string value_of(const Worsening& one, double value) {
  return one.what.find(' ') == std::string::npos ? campaign_report::value_text(one.what, value)
                                                 : fmt::format("{:.1f} %", 100.0 * value);
}

}  // namespace

Comparison compare(const Json& earlier, const Json& later) {
  Comparison comparison;
  std::vector<Worsening> all;
  for (const Json& after : later["rows"]) {
    const Json* const before = row_named(earlier, after["name"]);
    if (before == nullptr || !is_flown(*before) || !is_flown(after)) {
      comparison.not_compared.push_back(after["name"].get<std::string>());
      continue;
    }
    compare_quantities(*before, after, all);
    compare_shares(*before, after, all);
  }
  std::vector<double> p_values;
  for (const Worsening& one : all) p_values.push_back(one.adjusted_p);
  const std::vector<double> adjusted = campaign_report::holm(p_values);
  for (std::size_t k = 0; k < all.size(); ++k) {
    all[k].adjusted_p = adjusted[k];
    if (adjusted[k] <= kFamilyLevel) comparison.worse.push_back(all[k]);
  }
  comparison.tests = all.size();
  std::ranges::sort(comparison.worse, {}, &Worsening::adjusted_p);
  return comparison;
}

std::string text_of(const Comparison& comparison) {
  std::string text;
  for (const Worsening& one : comparison.worse)
    text += fmt::format("worse: {}: {}: {} in {} cases, before {} in {} (p {:.2g})\n", one.row, one.what,
                        value_of(one, one.later), one.later_cases, value_of(one, one.earlier), one.earlier_cases,
                        one.adjusted_p);
  text += fmt::format(
      "{} of {} comparisons are worse; rank tests of Mann and Whitney and exact tests of Fisher, one-sided, after "
      "Holm, "
      "{:g} % of all together\n",
      comparison.worse.size(), comparison.tests, 100.0 * kFamilyLevel);
  if (!comparison.not_compared.empty())
    text += fmt::format("not flown in one of both: {}\n", fmt::join(comparison.not_compared, ", "));
  return text;
}

}  // namespace vbar::verification
