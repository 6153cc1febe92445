// Scatter of errors with a direction across the track: CEP, R95 and the ellipse of the covariance.

#include <array>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "host_sim/campaign_report/case_text.h"
#include "host_sim/campaign_report/miss.h"
#include "host_sim/campaign_report/sections.h"
#include "host_sim/report/number_text.h"
#include "host_sim/report/svg_plot.h"

namespace vbar::campaign_report {
namespace {

using report::Mark;
using report::Plot;
using report::Point;

constexpr std::size_t kMaxErrors = 12;  // in the table; the last ones: the end of an approach
constexpr std::array<const char*, 3> kAxisNames{"radial", "along track", "normal"};

using Row = std::vector<std::string>;

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

}  // namespace vbar::campaign_report
