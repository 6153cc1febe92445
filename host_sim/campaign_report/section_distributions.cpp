// Distributions of the figures of complete cases: percentiles with bounds, histograms and distribution functions.

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "host_sim/campaign_report/case_text.h"
#include "host_sim/campaign_report/distribution_plots.h"
#include "host_sim/campaign_report/percentile.h"
#include "host_sim/campaign_report/sections.h"
#include "host_sim/campaign_report/sweep.h"
#include "host_sim/report/number_text.h"
#include "host_sim/report/statistics.h"

namespace vbar::campaign_report {
namespace {

constexpr std::array kShares{0.5, 0.9, 0.95, 0.99, 0.997};

using Row = std::vector<std::string>;

void add_percentiles(const Content& content, const Quantity& quantity, std::vector<Row>& rows) {
  const std::vector<double> sorted = sorted_values(quantity);
  const std::string limits = limits_text(quantity);
  rows.push_back({fmt::format(
      "{}{}{}: of {}, smallest {}, mean {}, largest {}", quantity.key, limits.empty() ? "" : ", ", limits,
      count_text(sorted.size(), "complete case", "complete cases"), value_text(quantity.key, sorted.front()),
      value_text(quantity.key, *report::mean_of(sorted)), value_text(quantity.key, sorted.back()))});
  const auto text = [&](const std::optional<double>& value, const std::string& none) {
    return value ? value_text(quantity.key, *value) : none;
  };
  for (const double share : kShares) {
    const std::string name = fmt::format("{:g} %", 100.0 * share);
    if (!content.campaign.is_independent) {
      rows.push_back({name, value_text(quantity.key, report::quantile(sorted, share)), "–", "–"});
      continue;
    }
    const Percentile found = percentile(sorted, share, kConfidence);
    rows.push_back({name, text(found.estimate, "–"), text(found.lower, "open"),
                    text(found.upper, fmt::format("open ({} needed)", values_needed(share, kConfidence)))});
  }
}

std::string notes(const Content& content) {
  const auto missing = count_cases(content.campaign, [](const Case& c) { return !c.is_complete(); });
  std::string text = "<p class=\"note\">Of complete cases";
  if (missing > 0)
    text += fmt::format("; <span class=\"bad\">{} without figures</span>", count_text(missing, "case is", "cases are"));
  text += ". ";
  if (content.campaign.is_independent) {
    text += fmt::format(
        "Bounds: two-sided, {:g} %, for any distribution (order statistics). Where the cases are too few for an upper "
        "bound it is open, the percentile is not stated, and the number of cases needed is.",
        100.0 * kConfidence);
    if (share_seeds(content.campaign))
      text += " Points of the sweeps share seeds, so that bounds over all of them are approximate.";
  } else {
    text += "The cases are not independent draws, so that the percentiles have no such bounds.";
  }
  return text + "</p>\n";
}

}  // namespace

report::Section distribution_section(const Content& content) {
  if (content.quantities.empty()) return {};
  std::vector<Row> rows;
  std::vector<report::Plot> plots;
  for (const Quantity& quantity : content.quantities) {
    add_percentiles(content, quantity, rows);
    const std::vector<double> sorted = sorted_values(quantity);
    plots.push_back(histogram(quantity, sorted));
    plots.push_back(distribution_function(quantity, sorted));
  }
  const std::vector<report::Column> columns{{"percentile"}, {"value"}, {"lower bound"}, {"upper bound"}};
  return {"Distributions",
          notes(content) + report::table(columns, rows) + report::plot_rows(2, std::move(plots)),
          {"results.csv"}};
}

}  // namespace vbar::campaign_report
