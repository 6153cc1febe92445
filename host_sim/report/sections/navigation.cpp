#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host_sim/report/plots/html_page.h"
#include "host_sim/report/run_series.h"
#include "host_sim/report/sections/sections.h"
#include "host_sim/report/statistics.h"

namespace vbar::report {
namespace {

constexpr const char* kAxes[] = {"R", "T", "N"};

// Smaller errors are rounding: 1 um at 75 km is 1e-11 of the state.
constexpr double kExactPosition_m = 1e-5;
constexpr double kExactVelocity_mps = 1e-8;

bool is_exact(const std::vector<NavigationError>& all) {
  return std::ranges::all_of(all, [](const NavigationError& e) {
    return magnitude(e.position_rtn) < kExactPosition_m && magnitude(e.velocity_rtn) < kExactVelocity_mps;
  });
}

/// Component of an error as a plot shows it.
struct Component {
  std::size_t axis = 0;
  bool velocity = false;

  [[nodiscard]] double error(const NavigationError& e) const {
    return (velocity ? e.velocity_rtn : e.position_rtn)[axis];
  }
  [[nodiscard]] double bound(const NavigationError& e) const { return 3.0 * e.sigma_rtn[axis + (velocity ? 3 : 0)]; }
};

/// Returns the range of what comes once navigation has settled: before, errors are a thousand times as large.
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
  const char* const axis = kAxes[what.axis];
  Plot plot =
      time_plot(view, fmt::format("{} error {}, {}", what.velocity ? "Velocity" : "Position", axis, view.name),
                fmt::format("{} error", axis), what.velocity ? Unit::kMetresPerSecond : Unit::kMetres, 220.0, &record);
  if (first_fix(record)) plot.y.range = settled_range(all, view, settled_from(record, view), what);
  const auto error = [&](const NavigationError& e) { return what.error(e); };
  const auto bound = [&](const NavigationError& e) { return what.bound(e); };
  plot.series = {{"estimate minus truth", 0, Mark::kLine, over_time(all, view, error)},
                 {"3σ of the filter", 1, Mark::kDashedLine, over_time(all, view, bound)},
                 {"", 1, Mark::kDashedLine, over_time(all, view, [&](const NavigationError& e) { return -bound(e); })}};
  return plot;
}

std::string error_plots(const RunRecord& record) {
  const std::vector<NavigationError> all = navigation_errors(record);
  if (all.empty()) return "<p>The flight software never had a valid estimate.</p>\n";
  if (is_exact(all)) {
    return fmt::format("<p>The {} valid estimates equal the truth to within 0.01 mm and 0.00001 mm/s.</p>\n",
                       all.size());
  }
  std::vector<Plot> plots;
  for (const View& view : mission_views(record)) {
    for (const bool velocity : {false, true}) {
      for (std::size_t axis = 0; axis < 3; ++axis) plots.push_back(error_plot(record, all, view, {axis, velocity}));
    }
  }
  return kPlotNote + plot_rows(3, std::move(plots));
}

}  // namespace

Section navigation_section(const RunRecord& record) {
  if (record.estimates.empty()) return {};
  return {"Navigation", error_plots(record), {"estimate.csv", "truth.csv"}};
}

}  // namespace vbar::report
