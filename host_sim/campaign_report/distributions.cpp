// Distributions of the figures of complete cases: percentiles with bounds, histograms and distribution functions.

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host_sim/campaign_report/page.h"
#include "host_sim/campaign_report/quantity.h"
#include "host_sim/campaign_report/statistics.h"
#include "host_sim/report/plots/number_text.h"
#include "host_sim/report/plots/svg_plot.h"
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

// Scatter of errors with a direction across the track: CEP, R95 and the ellipse of the covariance.

namespace {

using report::Mark;
using report::Plot;
using report::Point;

constexpr std::size_t kMaxErrors = 12;  // in the table; the last ones: the end of an approach
constexpr std::array<const char*, 3> kAxisNames{"radial", "along track", "normal"};

std::string metres(double value) {
  return report::measure_text(value, "m");
}

/// "1.2 mm (1.1 mm to open)"
std::string radius_text(const Percentile& radius, bool has_bounds) {
  const auto text = [](const std::optional<double>& value, const char* none) { return value ? metres(*value) : none; };
  if (!has_bounds) return text(radius.estimate, "–");
  return fmt::format("{} ({} to {})", text(radius.estimate, "–"), text(radius.lower, "open"),
                     text(radius.upper, "open"));
}

Row row_of(const Content& content, const Plane& plane, const PlaneMiss& miss) {
  const bool has_bounds = content.campaign.is_independent;
  return {plane.name, radius_text(miss.cep_m, has_bounds), radius_text(miss.r95_m, has_bounds),
          fmt::format("{}, {}", metres(miss.mean_m[0]), metres(miss.mean_m[1])),
          fmt::format("{}, {}", metres(miss.sigma_m[0]), metres(miss.sigma_m[1]))};
}

constexpr int kCorners = 72;  // corners of a circle as drawn

std::vector<Point> ellipse(const PlaneMiss& miss, double sigmas) {
  std::vector<Point> points;
  for (int k = 0; k <= kCorners; ++k) {
    const double turn = 2.0 * std::numbers::pi * k / kCorners;
    const double a = sigmas * miss.sigma_m[0] * std::cos(turn), b = sigmas * miss.sigma_m[1] * std::sin(turn);
    points.push_back({miss.mean_m[0] + a * std::cos(miss.angle_rad) - b * std::sin(miss.angle_rad),
                      miss.mean_m[1] + a * std::sin(miss.angle_rad) + b * std::cos(miss.angle_rad)});
  }
  return points;
}

std::vector<Point> circle(const std::optional<double>& radius) {
  std::vector<Point> points;
  for (int k = 0; radius && k <= kCorners; ++k) {
    const double turn = 2.0 * std::numbers::pi * k / kCorners;
    points.push_back({*radius * std::cos(turn), *radius * std::sin(turn)});
  }
  return points;
}

Plot scatter(const VectorError& error, const Plane& plane, const PlaneMiss& miss) {
  Plot plot;
  plot.title = fmt::format("{}, plane {}", error.key, plane.name);
  plot.x = {.name = kAxisNames[plane.first], .unit = report::Unit::kMetres};
  plot.y = {.name = kAxisNames[plane.second], .unit = report::Unit::kMetres};
  plot.same_scale = true;
  plot.height = 380.0;
  std::vector<Point> points;
  for (const auto& rtn : error.errors_rtn_m) points.push_back({rtn[plane.first], rtn[plane.second]});
  plot.series = {{"cases", 0, Mark::kDensity, std::move(points)},
                 {"CEP", 1, Mark::kLine, circle(miss.cep_m.estimate)},
                 {"R95", 1, Mark::kDashedLine, circle(miss.r95_m.estimate)},
                 {"3σ of the sample covariance", 2, Mark::kLine, ellipse(miss, 3.0)}};
  return plot;
}

}  // namespace

report::Section miss_section(const Content& content) {
  std::vector<VectorError> errors = vector_errors(content.campaign);
  if (errors.empty()) return {};
  const std::size_t shown = std::min(errors.size(), kMaxErrors);
  errors.erase(errors.begin(), errors.end() - static_cast<std::ptrdiff_t>(shown));
  std::vector<Row> rows;
  std::vector<Plot> plots;
  for (const VectorError& error : errors) {
    rows.push_back({fmt::format("{}: of {}", error.key,
                                count_text(error.errors_rtn_m.size(), "complete case", "complete cases"))});
    for (const Plane& plane : kPlanes) {
      const PlaneMiss miss = miss_in(plane, error, kConfidence);
      rows.push_back(row_of(content, plane, miss));
      if (&error == &errors.back()) plots.push_back(scatter(error, plane, miss));
    }
  }
  const std::vector<report::Column> columns{
      {"plane", false}, {"CEP (95 % bounds)"}, {"R95 (95 % bounds)"}, {"mean, each axis"}, {"σ, axes of the ellipse"}};
  return {
      "Miss distances",
      "<p class=\"note\">Circular error probable (CEP) and R95: radii about the aim that half of the cases and 95 % "
      "of them keep to, as percentiles, without the assumption of a Gaussian.</p>\n" +
          report::table(columns, rows) + report::plot_rows(2, std::move(plots)),
      {"results.csv"}};
}

// Dependence of the figures on the inputs: rank correlations with the swept and dispersed quantities, and scatter plots
// of the strongest.

namespace {

constexpr std::size_t kMaxRows = 30, kMaxPlots = 6, kMaxOtherPlots = 24;

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
  std::vector<Plot> plots, others_plotted;
  for (const Dependence& one : found) {
    const bool is_main = one.is_significant() && plots.size() < kMaxPlots;
    if (!is_main && one.response->quantity != nullptr && others_plotted.size() < kMaxOtherPlots)
      others_plotted.push_back(scatter(one));
    if (!one.is_significant()) continue;
    if (rows.size() < kMaxRows)
      rows.push_back({one.driver->name, one.response->name, report::grouped(one.correlation.count),
                      report::fixed(one.correlation.rho, 3),
                      one.adjusted_p < 1e-4 ? "< 0.0001" : fmt::format("{:.4f}", one.adjusted_p)});
    if (is_main && one.response->quantity != nullptr) plots.push_back(scatter(one));
  }
  std::string body = notes(content.campaign);
  if (!rows.empty())
    body += report::table({{"key", false}, {"figure", false}, {"cases"}, {"ρ"}, {"p, corrected"}}, rows);
  body += paragraph("Without a significant correlation", without_effect(inputs, found));
  body += paragraph("Not ranked, as their values are constant or not numbers", others);
  body += report::plot_rows(3, std::move(plots));
  if (!others_plotted.empty())
    body += fmt::format(
        "<details><summary>Each other figure over each key, the strongest correlations first</summary>\n{}</details>\n",
        report::plot_rows(3, std::move(others_plotted)));
  return {"What drives the figures", body, {"results.csv"}};
}

}  // namespace vbar::campaign_report
