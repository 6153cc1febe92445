#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host_sim/report/html_page.h"
#include "host_sim/report/number_text.h"
#include "host_sim/report/report_sections.h"
#include "host_sim/report/section_parts.h"

namespace vbar::report {
namespace {

/// A plane of the servicer's RTN frame: which component runs along x, which along y.
struct Plane {
  const char* title;
  std::size_t x, y;
  const char* x_name;
  const char* y_name;
};
constexpr Plane kPlanes[] = {{"T-R", 1, 0, "along track T", "radial R"},
                             {"N-R", 2, 0, "cross track N", "radial R"},
                             {"T-N", 1, 2, "along track T", "cross track N"}};

Point in_plane(const Plane& plane, const Triple& position_rtn) {
  return {position_rtn[plane.x], position_rtn[plane.y]};
}

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

Plot projection(const RunRecord& record, const View& view, const Plane& plane) {
  Plot plot;
  plot.title = fmt::format("{}, {}", plane.title, view.name);
  plot.x = {.name = plane.x_name, .unit = Unit::kMetres, .least_span = 0.01};
  plot.y = {.name = plane.y_name, .unit = Unit::kMetres, .least_span = 0.01};
  Series truth{.name = "true", .colour = 0};
  for (const TruthRow& row : record.truth) {
    if (view.holds(row.time_s)) truth.points.push_back(in_plane(plane, row.relative_position_rtn));
  }
  plot.same_scale = fits_same_scale(truth.points);
  plot.series.push_back(std::move(truth));
  for (const WaypointRow& row : view.waypoints) {
    plot.rings.push_back(
        {in_plane(plane, row.actual_position_rtn), std::to_string(row.index), ring_tooltip(record, row)});
  }
  return plot;
}

}  // namespace

Section trajectory_section(const RunRecord& record) {
  if (record.truth.empty()) return {};
  std::vector<Plot> plots;
  for (const View& view : mission_views(record)) {
    for (const Plane& plane : kPlanes) plots.push_back(projection(record, view, plane));
  }
  return {"Trajectory",
          "<p class=\"note\">True position of the target in the servicer's RTN frame. Rings: positions at the times of "
          "the waypoints. Each row shows one part of the approach.</p>\n" +
              plot_rows(3, std::move(plots)),
          {"truth.csv"}};
}

}  // namespace vbar::report
