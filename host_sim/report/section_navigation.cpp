#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "host_sim/report/html_page.h"
#include "host_sim/report/maneuver_series.h"
#include "host_sim/report/navigation_errors.h"
#include "host_sim/report/report_sections.h"
#include "host_sim/report/section_parts.h"

namespace vbar::report {
namespace {

constexpr const char* kAxes[] = {"R", "T", "N"};

// Below these an estimate is the truth but for rounding: 1 um at 75 km is 1e-11 of the state.
constexpr double kExactPosition_m = 1e-5;
constexpr double kExactVelocity_mps = 1e-8;

bool is_exact(const std::vector<NavigationError>& all) {
  return std::ranges::all_of(all, [](const NavigationError& e) {
    return magnitude(e.position_rtn) < kExactPosition_m && magnitude(e.velocity_rtn) < kExactVelocity_mps;
  });
}

/// What an error plot shows of one error.
struct Component {
  std::size_t axis = 0;
  bool velocity = false;

  [[nodiscard]] double error(const NavigationError& e) const {
    return (velocity ? e.velocity_rtn : e.position_rtn)[axis];
  }
  [[nodiscard]] double bound(const NavigationError& e) const { return 3.0 * e.sigma_rtn[axis + (velocity ? 3 : 0)]; }
};

/// Of what comes once navigation has settled: before, errors are a thousand times as large.
Range settled_range(const std::vector<NavigationError>& all, const View& view, double from_s, const Component& what) {
  double largest = 0.0;
  for (const NavigationError& e : all) {
    if (e.time_s >= from_s && view.holds(e.time_s))
      largest = std::max({largest, std::abs(what.error(e)), what.bound(e)});
  }
  return {-1.1 * largest, 1.1 * largest};
}

Plot error_plot(const RunRecord& record, const std::vector<NavigationError>& all, const View& view,
                const Component& what) {
  Plot plot;
  plot.title = fmt::format("{} {} error, {}", what.velocity ? "velocity" : "position", kAxes[what.axis], view.name);
  plot.x = time_axis(view);
  plot.y = {.name = fmt::format("{} error", kAxes[what.axis]),
            .unit = what.velocity ? Unit::kMetresPerSecond : Unit::kMetres};
  if (first_fix(record)) plot.y.range = settled_range(all, view, settled_from(record, view), what);
  plot.height = 220.0;
  plot.moments = waypoint_moments(view);
  plot.events = maneuver_events(record, view);
  const auto error = [&](const NavigationError& e) { return what.error(e); };
  const auto bound = [&](const NavigationError& e) { return what.bound(e); };
  plot.series = {{"estimated less true", 0, Mark::kLine, over_time(all, view, error)},
                 {"three sigma as the filter claims", 1, Mark::kDashedLine, over_time(all, view, bound)},
                 {"", 1, Mark::kDashedLine, over_time(all, view, [&](const NavigationError& e) { return -bound(e); })}};
  return plot;
}

std::string error_plots(const RunRecord& record) {
  const std::vector<NavigationError> all = navigation_errors(record);
  if (all.empty()) return "<p>The flight software never had a valid estimate.</p>\n";
  if (is_exact(all)) {
    return fmt::format("<p>The {} valid estimates are the truth: nearer than 0.01 mm and 0.00001 mm/s.</p>\n",
                       all.size());
  }
  std::vector<std::string> plots;
  std::vector<Series> keys;
  for (const View& view : mission_views(record)) {
    for (const bool velocity : {false, true}) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const Plot plot = error_plot(record, all, view, {axis, velocity});
        keys = {plot.series[0], plot.series[1]};
        plots.push_back(svg(plot));
      }
    }
  }
  const std::string note = "<p class=\"note\">Dashed lines: waypoints. Strokes on the lower edge: maneuvers.</p>\n";
  return note + legend(keys) + figures(3, plots);
}

std::string residual_plots(const RunRecord& record) {
  std::set<std::string> sensors;
  for (const ResidualRow& row : record.residuals) sensors.insert(row.sensor);
  const View whole = whole_run(record);
  std::vector<std::string> plots;
  std::vector<Series> keys;
  for (const std::string& sensor : sensors) {
    Plot plot;
    plot.title = sensor;
    plot.x = time_axis(whole);
    plot.y = {.name = "residual", .unit = Unit::kSigmas};
    plot.width = 580.0;
    plot.moments = waypoint_moments(whole);
    plot.series = {{"before the update", 5, Mark::kDots, {}}, {"after the update", 0, Mark::kDots, {}}};
    for (const ResidualRow& row : record.residuals) {
      if (row.sensor != sensor || !(row.sigma > 0.0)) continue;
      plot.series[0].points.push_back({hours(row.time_s), row.prefit / row.sigma});
      plot.series[1].points.push_back({hours(row.time_s), row.postfit / row.sigma});
    }
    keys = plot.series;
    plots.push_back(svg(plot));
  }
  if (plots.empty()) return {};
  return "<h3>Residuals, over their standard deviation</h3>\n" + legend(keys) + figures(2, plots);
}

}  // namespace

std::string navigation_section(const RunRecord& record) {
  if (record.estimates.empty()) return {};
  return section("Navigation", error_plots(record) + residual_plots(record));
}

}  // namespace vbar::report
