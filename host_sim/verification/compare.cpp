#include "host_sim/verification/compare.h"

#include <algorithm>

#include <fmt/format.h>

#include "host_sim/campaign_report/quantity.h"
#include "host_sim/campaign_report/statistics.h"
#include "host_sim/report/statistics.h"
#include "host_sim/verification/rank_tests.h"

namespace vbar::verification {

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
