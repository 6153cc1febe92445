#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

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

/// The largest error or bound of a view from a time on.
double largest_from(const std::vector<NavigationError>& all, const View& view, double from_s, const Component& what) {
  double largest = 0.0;
  for (const NavigationError& e : all) {
    if (e.time_s >= from_s && view.holds(e.time_s))
      largest = std::max({largest, std::abs(what.error(e)), what.bound(e)});
  }
  return largest;
}

/// Returns the range of what comes once navigation has settled, after an eighth of the view or the first fix, where
/// errors before are several times as large; none where they are not.
std::optional<Range> settled_range(const RunRecord& record, const std::vector<NavigationError>& all, const View& view,
                                   const Component& what) {
  constexpr double kSettling = 0.125, kSeveral = 3.0;
  const bool has_fix = first_fix(record).has_value();
  const double from_s = has_fix ? settled_from(record, view) : view.start_s + kSettling * (view.end_s - view.start_s);
  const double settled = largest_from(all, view, from_s, what);
  if (!has_fix && largest_from(all, view, view.start_s, what) < kSeveral * settled) return std::nullopt;
  return settled > 0.0 ? std::optional(Range{-1.1 * settled, 1.1 * settled}) : std::nullopt;
}

Plot error_plot(const RunRecord& record, const std::vector<NavigationError>& all, const View& view,
                const Component& what) {
  const char* const axis = kAxes[what.axis];
  Plot plot =
      time_plot(view, fmt::format("{} error {}, {}", what.velocity ? "Velocity" : "Position", axis, view.name),
                fmt::format("{} error", axis), what.velocity ? Unit::kMetresPerSecond : Unit::kMetres, 220.0, &record);
  plot.y.range = settled_range(record, all, view, what);
  const auto error = [&](const NavigationError& e) { return what.error(e); };
  const auto bound = [&](const NavigationError& e) { return what.bound(e); };
  plot.series = {{"estimate minus truth", 0, Mark::kLine, over_time(all, view, error)},
                 {"3σ of the filter", 1, Mark::kDashedLine, over_time(all, view, bound)},
                 {"", 1, Mark::kDashedLine, over_time(all, view, [&](const NavigationError& e) { return -bound(e); })}};
  return plot;
}

/// A sentence where a view has no estimate, or none in its last part.
std::string missing_estimates(const std::vector<NavigationError>& all, const View& view) {
  constexpr double kNoticed = 0.02;  // of the view
  double last_s = view.start_s;
  bool is_any = false;
  for (const NavigationError& e : all) {
    if (!view.holds(e.time_s)) continue;
    last_s = e.time_s;
    is_any = true;
  }
  if (!is_any) return fmt::format("<p class=\"caution\">No estimate, {}.</p>\n", view.name);
  if (view.end_s - last_s < kNoticed * (view.end_s - view.start_s)) return {};
  return fmt::format("<p class=\"caution\">No estimate after {:.2f} h, {}.</p>\n", hours(last_s), view.name);
}

std::string error_plots(const RunRecord& record) {
  const std::vector<NavigationError> all = navigation_errors(record);
  if (all.empty()) return "<p>The flight software never had a valid estimate.</p>\n";
  if (is_exact(all)) {
    return fmt::format("<p>The {} valid estimates equal the truth to within 0.01 mm and 0.00001 mm/s.</p>\n",
                       all.size());
  }
  std::vector<Plot> plots;
  std::string missing;
  for (const View& view : mission_views(record)) {
    missing += missing_estimates(all, view);
    if (std::ranges::none_of(all, [&](const NavigationError& e) { return view.holds(e.time_s); })) continue;
    for (const bool velocity : {false, true}) {
      for (std::size_t axis = 0; axis < 3; ++axis) plots.push_back(error_plot(record, all, view, {axis, velocity}));
    }
  }
  return missing + kPlotNote +
         "<p class=\"note\">Where the first errors of a plot are several times those that follow, its axis shows what "
         "follows.</p>\n" +
         plot_rows(3, std::move(plots));
}

}  // namespace

Section navigation_section(const RunRecord& record) {
  if (record.estimates.empty()) return {};
  return {"Navigation", error_plots(record), {"estimate.csv", "truth.csv"}};
}

}  // namespace vbar::report
