#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "host_sim/report/plots/html_page.h"
#include "host_sim/report/plots/number_text.h"
#include "host_sim/report/sections/sections.h"

namespace vbar::report {

namespace {

// Below this ratio of the axes a common scale leaves both readable.
constexpr double kFlattest = 6.0;

bool fits_same_scale(const std::vector<Point>& points) {
  std::vector<double> xs, ys;
  for (const Point& p : points) {
    xs.push_back(p.x);
    ys.push_back(p.y);
  }
  const auto x = range_of(xs);
  const auto y = range_of(ys);
  return x && y && x->span() <= kFlattest * y->span() && y->span() <= kFlattest * x->span();
}

std::string ring_tooltip(const RunRecord& record, const WaypointRow& row) {
  const Triple& p = row.actual_position_rtn;
  const std::string place = fmt::format("waypoint {} at {} h: R {}, T {}, N {} m", row.index,
                                        fixed(hours(row.time_s), 2), fixed(p[0], 3), fixed(p[1], 3), fixed(p[2], 3));
  if (is_start(record, row)) return "start, " + place;
  return fmt::format("{}; control error {} m", place, fixed(row.control_error_m, 4));
}

Plot projection(const RunRecord& record, const View& view, const RtnPlane& plane) {
  Plot plot = plane_plot(view, plane);
  Series truth{.name = "true", .colour = 0, .points = path_in(plane, view, record)};
  plot.same_scale = fits_same_scale(truth.points);
  plot.series.push_back(std::move(truth));
  for (const WaypointRow& row : view.waypoints) {
    plot.rings.push_back({plane.of(row.actual_position_rtn), std::to_string(row.index), ring_tooltip(record, row)});
  }
  return plot;
}

}  // namespace

Section trajectory_section(const RunRecord& record) {
  if (record.truth.empty()) return {};
  std::vector<Plot> plots;
  for (const View& view : mission_views(record)) {
    for (const RtnPlane& plane : kRtnPlanes) plots.push_back(projection(record, view, plane));
  }
  return {"Trajectory",
          "<p class=\"note\">True position of the target in the servicer's RTN frame. Rings: positions at the times of "
          "the waypoints. Each row shows one part of the approach.</p>\n" +
              plot_rows(3, std::move(plots)),
          {"truth.csv"}};
}

namespace {

/// A flight computer without mean ROE reports zeros.
bool has_estimate(const EstimateRow& row) {
  return row.navigation_valid != 0 && row.a_roe_mean_m != Sextuple{};
}

Plot element_plot(const RunRecord& record, const View& view, std::size_t k) {
  Plot plot =
      time_plot(view, fmt::format("{}, {}", kElementNames[k], view.name), kElementNames[k], Unit::kMetres, 220.0);
  plot.y.min_span = kMinElementSpan_m;
  plot.series = {{"true", 0, Mark::kBroadLine,
                  over_time(record.truth, view, [k](const TruthRow& r) { return r.a_roe_mean_m[k]; })},
                 {"estimated", 1, Mark::kLine,
                  over_time(record.estimates, view,
                            [k](const EstimateRow& r) { return has_estimate(r) ? r.a_roe_mean_m[k] : std::nan(""); })},
                 {"desired at the next waypoint", 5, Mark::kDashedLine, {}}};
  std::vector<Point>& desired = plot.series[2].points;
  for (const EstimateRow& row : record.estimates) {
    if (!view.holds(row.time_s) || row.waypoint_index < 0) continue;
    // The desired elements change at once with the next waypoint.
    if (!desired.empty() && desired.back().y != row.a_roe_desired_m[k]) {
      desired.push_back({hours(row.time_s), desired.back().y});
    }
    desired.push_back({hours(row.time_s), row.a_roe_desired_m[k]});
  }
  for (const WaypointRow& row : view.waypoints) {
    plot.rings.push_back({{hours(row.time_s), row.a_roe_desired_m[k]},
                          "",
                          fmt::format("waypoint {}: {} m desired, {} m true", row.index,
                                      fixed(row.a_roe_desired_m[k], 3), fixed(row.a_roe_actual_m[k], 3))});
  }
  return plot;
}

}  // namespace

Section elements_section(const RunRecord& record) {
  if (record.truth.empty()) return {};
  const std::vector<View> views = mission_views(record);
  std::vector<Plot> plots;
  for (std::size_t k = 0; k < kElementNames.size(); ++k) {
    for (const View& view : views) plots.push_back(element_plot(record, view, k));
  }
  return {"Relative orbital elements",
          "<p class=\"note\">Mean ROE of the target with respect to the servicer, times the reference semi-major axis. "
          "Rings and dashed vertical lines: waypoints.</p>\n" +
              plot_rows(columns_for(views.size()), std::move(plots)),
          {"truth.csv", "estimate.csv"}};
}

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
  plot.y.min_span = kLeastRateSpan_radps;
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
  plot.y.min_span = kLeastRateSpan_radps;
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
