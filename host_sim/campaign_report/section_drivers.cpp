// Dependence of the figures on the inputs: rank correlations with the swept and dispersed quantities, and scatter plots
// of the strongest.

#include <algorithm>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host_sim/campaign_report/drivers.h"
#include "host_sim/campaign_report/sections.h"
#include "host_sim/campaign_report/sweep.h"
#include "host_sim/report/number_text.h"

namespace vbar::campaign_report {
namespace {

using report::Plot;
using report::Point;

constexpr std::size_t kMaxRows = 30, kMaxPlots = 6;

Plot scatter(const Dependence& found) {
  Plot plot;
  plot.title = fmt::format("{}, ρ = {:.2f}", found.response->name, found.correlation.rho);
  plot.x = axis_of(found.driver->name);
  plot.x.name = found.driver->name;
  plot.y = axis_of(found.response->name);
  plot.y.logarithmic = is_heavy_tailed(sorted_values(*found.response->quantity));
  plot.height = 260.0;
  std::vector<Point> points;
  for (std::size_t k = 0; k < found.driver->values.size(); ++k)
    points.push_back({found.driver->values[k], found.response->values[k]});
  plot.series = {{"", 0, report::Mark::kDensity, std::move(points)}};
  if (const auto& max = found.response->quantity->max) {
    const report::Range range = *report::range_of(found.driver->values);
    plot.series.push_back({"", 1, report::Mark::kDashedLine, {{range.low, *max}, {range.high, *max}}});
  }
  return plot;
}

/// Drivers without a significant dependence.
std::vector<std::string> without_effect(const std::vector<Driver>& drivers, const std::vector<Dependence>& found) {
  std::set<std::string> with_effect;
  for (const Dependence& one : found)
    if (one.is_significant()) with_effect.insert(one.driver->name);
  std::vector<std::string> names;
  for (const Driver& driver : drivers)
    if (!with_effect.contains(driver.name)) names.push_back(driver.name);
  return names;
}

std::string paragraph(const char* what, const std::vector<std::string>& names) {
  if (names.empty()) return {};
  return fmt::format("<p>{}: {}.</p>\n", what, report::escaped(fmt::format("{}", fmt::join(names, ", "))));
}

std::string notes(const Campaign& campaign) {
  std::string text = fmt::format(
      "<p class=\"note\">Spearman's rank correlation of at least {} complete cases; &quot;not passed&quot; includes "
      "failed "
      "cases. Significant: p below 0.05 after Holm's correction for all pairs.",
      kMinPairs);
  if (share_seeds(campaign)) text += " Points of the sweeps share seeds, so that p values are approximate.";
  return text + "</p>\n";
}

}  // namespace

report::Section driver_section(const Content& content) {
  std::vector<std::string> others;
  const std::vector<Driver> inputs = drivers(content.campaign, others);
  const std::vector<Response> outputs = responses(content.campaign, content.quantities);
  const std::vector<Dependence> found = dependences(inputs, outputs);
  if (found.empty()) return {};
  std::vector<std::vector<std::string>> rows;
  std::vector<Plot> plots;
  for (const Dependence& one : found) {
    if (!one.is_significant()) continue;
    if (rows.size() < kMaxRows)
      rows.push_back({one.driver->name, one.response->name, report::grouped(one.correlation.count),
                      report::fixed(one.correlation.rho, 3),
                      one.adjusted_p < 1e-4 ? "< 0.0001" : fmt::format("{:.4f}", one.adjusted_p)});
    if (plots.size() < kMaxPlots && one.response->quantity != nullptr) plots.push_back(scatter(one));
  }
  std::string body = notes(content.campaign);
  if (!rows.empty())
    body += report::table({{"key", false}, {"figure", false}, {"cases"}, {"ρ"}, {"p, corrected"}}, rows);
  body += paragraph("Without a significant correlation", without_effect(inputs, found));
  body += paragraph("Not ranked, as their values are constant or not numbers", others);
  return {"What drives the figures", body + report::plot_rows(3, std::move(plots)), {"results.csv"}};
}

}  // namespace vbar::campaign_report
