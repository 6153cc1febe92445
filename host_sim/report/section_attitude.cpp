#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "host_sim/report/html_page.h"
#include "host_sim/report/report_sections.h"
#include "host_sim/report/section_parts.h"

namespace vbar::report {
namespace {

/// A tumble of a degree per second over the whole mission would be a black band; two orbits are readable.
constexpr double kClose_s = 12000.0;

/// 1e-4 deg/s: a smaller range would show the rounding of a constant rate.
constexpr double kLeastRateSpan_radps = 2e-6;

View beginning_of(const View& run) {
  View view = run;
  view.end_s = std::min(run.end_s, run.start_s + kClose_s);
  view.waypoints.clear();
  for (const WaypointRow& row : run.waypoints)
    if (view.holds(row.time_s)) view.waypoints.push_back(row);
  return view;
}

/// Angle of the rotation from one attitude to the other, 0 to pi.
double angle_between(const Quadruple& a, const Quadruple& b) {
  double cosine = 0.0;
  for (std::size_t k = 0; k < 4; ++k) cosine += a[k] * b[k];
  return 2.0 * std::acos(std::min(std::abs(cosine), 1.0));
}

Plot angle_plot(const std::string& spacecraft, const std::vector<AttitudeRow>& rows, const View& view) {
  Plot plot = time_plot(view, fmt::format("{}, rotation since the start", spacecraft), "angle", Unit::kRadians, 220.0);
  const auto angle = [&](const AttitudeRow& row) { return angle_between(row.q_body_eci, rows.front().q_body_eci); };
  plot.series = {{"", 0, Mark::kLine, over_time(rows, view, angle)}};
  return plot;
}

Plot components_plot(const std::string& spacecraft, const std::vector<AttitudeRow>& rows, const View& view) {
  Plot plot = time_plot(view, fmt::format("{}, angular rate about body axes", spacecraft), "rate",
                        Unit::kRadiansPerSecond, 220.0);
  plot.y.least_span = kLeastRateSpan_radps;
  constexpr std::array<const char*, 3> kAxes{"x", "y", "z"};
  for (std::size_t k = 0; k < 3; ++k) {
    const auto component = [k](const AttitudeRow& row) { return row.rate_body_radps[k]; };
    plot.series.push_back({kAxes[k], static_cast<int>(k), Mark::kLine, over_time(rows, view, component)});
  }
  return plot;
}

Plot size_plot(const std::string& spacecraft, const std::vector<AttitudeRow>& rows, const View& view) {
  Plot plot = time_plot(view, fmt::format("{}, magnitude of the rate, whole run", spacecraft), "rate",
                        Unit::kRadiansPerSecond, 220.0);
  plot.y.least_span = kLeastRateSpan_radps;
  const auto size = [](const AttitudeRow& row) { return magnitude(row.rate_body_radps); };
  plot.series = {{"", 0, Mark::kLine, over_time(rows, view, size)}};
  return plot;
}

}  // namespace

Section attitude_section(const RunRecord& record) {
  if (record.attitudes.empty()) return {};
  std::map<std::string, std::vector<AttitudeRow>> rows_of;
  for (const AttitudeRow& row : record.attitudes) rows_of[row.spacecraft].push_back(row);
  const View run = whole_run(record);
  const View beginning = beginning_of(run);
  std::vector<Plot> plots;
  for (const auto& [spacecraft, rows] : rows_of) {
    plots.push_back(angle_plot(spacecraft, rows, beginning));
    plots.push_back(components_plot(spacecraft, rows, beginning));
    plots.push_back(size_plot(spacecraft, rows, run));
  }
  return {"Attitude",
          "<p class=\"note\">True attitude at flight steps: the angle between the attitude and that of the first step, "
          "and the angular rate with respect to ECI. Dashed vertical lines: waypoints.</p>\n" +
              plot_rows(3, std::move(plots)),
          {"attitude.csv"}};
}

}  // namespace vbar::report
