#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>

#include "host_sim/report/html_page.h"
#include "host_sim/report/report_sections.h"
#include "host_sim/report/section_parts.h"

namespace vbar::report {
namespace {

constexpr const char* kAxes[] = {"R", "T", "N"};

/// An estimate beside the truth of its time.
struct Compared {
  double time_s = 0.0;
  Triple position_error{}, velocity_error{};
  Sextuple sigma{};
};

std::vector<Compared> compare(const RunRecord& record) {
  std::map<double, const TruthRow*> truth_at;
  for (const TruthRow& row : record.truth) truth_at[row.time_s] = &row;
  std::vector<Compared> all;
  for (const EstimateRow& row : record.estimates) {
    const auto truth = truth_at.find(row.time_s);
    if (row.navigation_valid == 0 || truth == truth_at.end()) continue;
    Compared& c = all.emplace_back();
    c.time_s = row.time_s;
    c.sigma = row.sigma_rtn;
    for (std::size_t k = 0; k < 3; ++k) {
      c.position_error[k] = row.relative_position_rtn[k] - truth->second->relative_position_rtn[k];
      c.velocity_error[k] = row.relative_velocity_rtn[k] - truth->second->relative_velocity_rtn[k];
    }
  }
  return all;
}

// Below these an estimate is the truth but for rounding: 1 um at 75 km is 1e-11 of the state.
constexpr double kExactPosition_m = 1e-5;
constexpr double kExactVelocity_mps = 1e-8;

bool is_exact(const std::vector<Compared>& all) {
  return std::ranges::all_of(all, [](const Compared& c) {
    return std::hypot(c.position_error[0], c.position_error[1], c.position_error[2]) < kExactPosition_m &&
           std::hypot(c.velocity_error[0], c.velocity_error[1], c.velocity_error[2]) < kExactVelocity_mps;
  });
}

Plot error_plot(const std::vector<Compared>& all, const View& view, std::size_t axis, bool velocity) {
  Plot plot;
  plot.title = fmt::format("{} {} error, {}", velocity ? "velocity" : "position", kAxes[axis], view.name);
  plot.x = time_axis(view);
  plot.y = {.name = fmt::format("{} error", kAxes[axis]), .unit = velocity ? Unit::kMetresPerSecond : Unit::kMetres};
  plot.height = 220.0;
  plot.moments = waypoint_moments(view);
  const auto error = [&](const Compared& c) { return (velocity ? c.velocity_error : c.position_error)[axis]; };
  const auto bound = [&](const Compared& c) { return 3.0 * c.sigma[axis + (velocity ? 3 : 0)]; };
  plot.series = {{"estimated less true", 0, Mark::kLine, over_time(all, view, error)},
                 {"three sigma as the filter claims", 1, Mark::kDashedLine, over_time(all, view, bound)},
                 {"", 1, Mark::kDashedLine, over_time(all, view, [&](const Compared& c) { return -bound(c); })}};
  return plot;
}

std::string error_plots(const RunRecord& record) {
  const std::vector<Compared> all = compare(record);
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
        const Plot plot = error_plot(all, view, axis, velocity);
        keys = {plot.series[0], plot.series[1]};
        plots.push_back(svg(plot));
      }
    }
  }
  return legend(keys) + figures(3, plots);
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
