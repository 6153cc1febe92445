#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "host_sim/report/html_page.h"
#include "host_sim/report/image_png.h"
#include "host_sim/report/maneuver_series.h"
#include "host_sim/report/navigation_errors.h"
#include "host_sim/report/number_text.h"
#include "host_sim/report/paper_experiment1.h"
#include "host_sim/report/report_sections.h"
#include "host_sim/report/section_parts.h"

namespace vbar::report {
namespace {

// ------------------------------------------------------------------------------------------------- table of the paper

struct Metric {
  const char* name;
  std::function<std::optional<double>(const WaypointRow&)> value;
  double paper1::Loop::*papers_value;
};

const std::vector<Metric> kMetrics{
    {"navigation error, m", [](const WaypointRow& row) { return row.navigation_error_m; },
     &paper1::Loop::navigation_error_m},
    {"control error, m", [](const WaypointRow& row) { return row.control_error_m; }, &paper1::Loop::control_error_m}};

std::vector<std::string> papers_row(const RunRecord& record, const char* loop, const Metric& metric,
                                    paper1::Loop paper1::Waypoint::*which) {
  std::vector<std::string> cells{"", loop};
  for (const WaypointRow& row : record.waypoints) {
    const paper1::Waypoint* const same = paper1::waypoint(row);
    cells.push_back(fixed(same != nullptr ? std::optional((same->*which).*metric.papers_value) : std::nullopt, 2));
  }
  return cells;
}

/// The paper's numbers stand under those of a run that meets its waypoints.
std::string performance_table(const RunRecord& record) {
  std::vector<Column> columns{{"", false}, {"", false}};
  for (const WaypointRow& row : record.waypoints) columns.push_back({fmt::format("waypoint {}", row.index)});
  const bool is_beside_the_paper =
      std::ranges::any_of(record.waypoints, [](const WaypointRow& row) { return paper1::waypoint(row) != nullptr; });
  std::vector<std::vector<std::string>> rows;
  for (const Metric& metric : kMetrics) {
    std::vector<std::string>& cells = rows.emplace_back(std::vector<std::string>{metric.name, "this run"});
    for (const WaypointRow& row : record.waypoints) cells.push_back(fixed(metric.value(row), 2));
    if (!is_beside_the_paper) continue;
    rows.push_back(papers_row(record, "paper, software in the loop", metric, &paper1::Waypoint::software));
    rows.push_back(papers_row(record, "paper, hardware in the loop", metric, &paper1::Waypoint::hardware));
  }
  std::string out = table(columns, rows);
  const Summary& s = record.summary;
  out += fmt::format("<p>Delta-v: {} m/s in {} maneuvers", fixed(s.dv_mps, 3), s.maneuvers);
  if (is_beside_the_paper) {
    out += fmt::format("; the paper&#39;s {} (software in the loop) and {} (hardware in the loop)",
                       paper1::kDeltaVSoftware, paper1::kDeltaVHardware);
  }
  return out + ".</p>\n";
}

// ----------------------------------------------------------------------------------------------------------- in words

constexpr double kArcsecond = M_PI / 648000.0;

/// 95 % of chi-square with two degrees of freedom lies below 5.991.
constexpr double kNis95 = 5.991;

std::string nis_text(const RunRecord& record) {
  double sum = 0.0;
  int count = 0, inside = 0;
  for (const ImageRow& row : record.images) {
    if (row.fate != telemetry_image::kEditFilter || !std::isfinite(row.nis)) continue;
    sum += row.nis;
    ++count;
    if (row.nis <= kNis95) ++inside;
  }
  if (count == 0) return "–";
  return fmt::format("mean {}, {} % of {} below the 95 % limit", fixed(sum / count, 2),
                     fixed(100.0 * inside / count, 1), count);
}

/// Of the images that had an attitude.
std::string stars_text(const RunRecord& record) {
  std::vector<int> stars;
  for (const ImageRow& row : record.images)
    if (row.star_method != 0) stars.push_back(row.stars);
  if (stars.empty()) return "never";
  std::ranges::sort(stars);
  return fmt::format("{} to {}, median {}", stars.front(), stars.back(), stars[stars.size() / 2]);
}

std::string facts(const RunRecord& record) {
  const Summary& s = record.summary;
  const ImageCounts counts = s.images.value_or(ImageCounts{});
  const ImageRow& last = record.images.back();
  std::vector<Fact> facts{{"images", fmt::format("{}, {} with a bearing, {} without stars", counts.images,
                                                 counts.with_bearing, last.images_without_stars)},
                          {"choices that were not the target", std::to_string(counts.wrong_targets)},
                          {"bearings", fmt::format("{} used, {} refused", last.bearings_used, last.bearings_refused)},
                          {"stars an image", stars_text(record)},
                          {"NIS, 2 expected", nis_text(record)},
                          {"NEES, 6 expected", fixed(s.navigation_nees, 2)},
                          {"tiles refused", std::to_string(last.tiles_refused)}};
  if (const auto& error = s.bearing_error_arcsec) {
    facts.push_back({"bearing error, target within a pixel", fmt::format("noise {} arcsec an axis, bias {} arcsec",
                                                                         fixed(error->std, 2), fixed(error->bias, 2))});
  }
  if (const auto& error = s.star_attitude_error_arcsec) {
    facts.push_back(
        {"boresight by the stars", fmt::format("error {} ± {} arcsec", fixed(error->mean, 2), fixed(error->std, 2))});
  }
  return fact_list(facts);
}

// --------------------------------------------------------------------------------------------------------------- plots

Plot empty_plot(const RunRecord& record, const View& view, const char* title, const char* quantity, Unit unit) {
  Plot plot;
  plot.title = title;
  plot.x = time_axis(view);
  plot.y = {.name = quantity, .unit = unit};
  plot.width = 580.0;
  plot.moments = waypoint_moments(view);
  plot.events = maneuver_events(record, view);
  return plot;
}

/// (hours, value(row)) of the images for which it gives one.
template <class Value>
std::vector<Point> points_of(const RunRecord& record, const View& view, const Value& value) {
  std::vector<Point> points;
  for (const ImageRow& row : record.images) {
    const std::optional<double> one = value(row);
    if (one && view.holds(row.time_s)) points.push_back({hours(row.time_s), *one});
  }
  return points;
}

/// Symmetric, and wide enough for all but the largest one in a hundred: a single outlier would flatten the rest.
Range range_of_most(const std::vector<Series>& series) {
  std::vector<double> sizes;
  for (const Series& one : series)
    for (const Point& point : one.points)
      if (std::isfinite(point.y)) sizes.push_back(std::abs(point.y));
  if (sizes.empty()) return {-1.0, 1.0};
  std::ranges::sort(sizes);
  const double most = std::max(1.2 * sizes[(sizes.size() * 99) / 100], 1e-3);
  return {-most, most};
}

/// Two plots, of the camera's x and y.
std::vector<Plot> residual_plots(const RunRecord& record, const View& view) {
  std::vector<Plot> plots;
  for (const std::size_t axis : {0U, 1U}) {
    Plot plot = empty_plot(record, view, axis == 0 ? "Residuals across, camera x" : "Residuals up and down, camera y",
                           "residual", Unit::kArcseconds);
    const auto values = [&](double(telemetry_image::*residual)[2]) {
      return points_of(record, view, [&](const ImageRow& row) {
        return row.fate >= telemetry_image::kEditFilter ? std::optional((row.*residual)[axis] / kArcsecond)
                                                        : std::nullopt;
      });
    };
    plot.series = {{"before the update", 5, Mark::kDots, values(&telemetry_image::prefit)},
                   {"after the update", 0, Mark::kDots, values(&telemetry_image::postfit)}};
    plot.y.range = range_of_most(plot.series);
    plots.push_back(std::move(plot));
  }
  return plots;
}

/// On a logarithmic scale: what reflects light is some decimetres beside the centre of mass, 1 arcsec of the first
/// image's range and 300 of the last one's.
Plot bearing_error_plot(const RunRecord& record, const View& view) {
  Plot plot = empty_plot(record, view, "Error of the measured bearing", "error", Unit::kArcseconds);
  plot.y.logarithmic = true;
  const auto of_bearings = [&](const auto& value) {
    return points_of(record, view, [&](const ImageRow& row) {
      return row.bearing_error_x_arcsec ? std::optional<double>(value(row)) : std::nullopt;
    });
  };
  plot.series = {{"size", 0, Mark::kDots, of_bearings([](const ImageRow& row) {
                    return std::hypot(*row.bearing_error_x_arcsec, row.bearing_error_y_arcsec.value_or(0.0));
                  })},
                 {"one sigma of an axis as it claims", 1, Mark::kDashedLine,
                  of_bearings([](const ImageRow& row) { return row.bearing_sigma / kArcsecond; })}};
  return plot;
}

Plot attitude_error_plot(const RunRecord& record, const View& view) {
  Plot plot = empty_plot(record, view, "Error of the attitude by the stars", "error", Unit::kArcseconds);
  plot.series = {{"of the boresight", 0, Mark::kDots,
                  points_of(record, view, [](const ImageRow& r) { return r.attitude_error_across_arcsec; })},
                 {"about the boresight", 5, Mark::kDots,
                  points_of(record, view, [](const ImageRow& r) { return r.attitude_error_roll_arcsec; })}};
  plot.y.range = Range{0.0, range_of_most(plot.series).high};
  return plot;
}

Plot objects_plot(const RunRecord& record, const View& view) {
  Plot plot = empty_plot(record, view, "Objects in the image", "objects", Unit::kNone);
  const auto values = [&](std::int16_t telemetry_image::*count) {
    return points_of(record, view,
                     [count](const ImageRow& row) { return std::optional(static_cast<double>(row.*count)); });
  };
  plot.series = {{"detected", 5, Mark::kDots, values(&ImageRow::objects)},
                 {"stars identified", 0, Mark::kDots, values(&ImageRow::stars)}};
  double most = 1.0;
  for (const ImageRow& row : record.images) most = std::max({most, 1.0 * row.objects, 1.0 * row.stars});
  plot.y.range = from_zero_to(most);
  return plot;
}

/// Bearings alone tell little of the range: how much, is the question of this kind of navigation.
Plot range_plot(const RunRecord& record, const View& view) {
  Plot plot = empty_plot(record, view, "Range, its error and what the filter claims", "range", Unit::kMetres);
  plot.y.logarithmic = true;
  Series truth{"true range", 2, Mark::kLine, {}}, error{"its error", 0, Mark::kLine, {}},
      sigma{"one sigma along the line of sight", 1, Mark::kDashedLine, {}};
  std::size_t next = 0;
  for (const NavigationError& e : navigation_errors(record)) {
    while (next < record.truth.size() && record.truth[next].time_s < e.time_s) ++next;
    if (next == record.truth.size() || !view.holds(e.time_s)) break;
    const Triple& position = record.truth[next].relative_position_rtn;
    const double range = magnitude(position);
    double along = 0.0, variance = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      along += e.position_rtn[k] * position[k] / range;
      variance += std::pow(e.sigma_rtn[k] * position[k] / range, 2);
    }
    truth.points.push_back({hours(e.time_s), range});
    error.points.push_back({hours(e.time_s), std::abs(along)});
    sigma.points.push_back({hours(e.time_s), std::sqrt(variance)});
  }
  plot.series = {std::move(truth), std::move(error), std::move(sigma)};
  return plot;
}

// ------------------------------------------------------------------------------------------------------------- gallery

std::string gallery(const RunRecord& record) {
  if (record.gallery.empty()) return {};
  std::vector<std::string> pictures;
  for (const GalleryImage& image : record.gallery) {
    const std::string caption =
        fmt::format("image {} at {} h: {}", image.image, fixed(hours(image.time_s), 2), image.caption);
    pictures.push_back(
        fmt::format("<img class=\"picture\" alt=\"{0}\" src=\"{1}\"/>"
                    "<figcaption>{0}</figcaption>",
                    escaped(caption), png_data_uri(image.png)));
  }
  return "<h3>Images</h3>\n<p class=\"note\">As the flight software got them, with its own findings: red boxes are "
         "stars that it identified, the green circle is its target, blue triangles are objects that it did not "
         "match. Dark violet did not arrive.</p>\n" +
         figures(3, pictures);
}

}  // namespace

std::string angles_only_section(const RunRecord& record) {
  if (record.images.empty()) return {};
  const View view = whole_run(record);
  const std::vector<Plot> residuals = residual_plots(record, view);
  const Plot bearing = bearing_error_plot(record, view), attitude = attitude_error_plot(record, view);
  const Plot objects = objects_plot(record, view), range = range_plot(record, view);
  return section(
      "Angles-only navigation",
      performance_table(record) + facts(record) +
          "<p class=\"note\">Errors of bearings are against the target's centre of mass; what reflects light lies up "
          "to "
          "some decimetres beside it, which shows at close range. Linear plots leave out the largest hundredth of "
          "their dots. "
          "Dashed lines: waypoints. Strokes on the lower edge: maneuvers.</p>\n" +
          legend(residuals[0].series) + figures(2, {svg(residuals[0]), svg(residuals[1])}) + legend(bearing.series) +
          legend(attitude.series) + figures(2, {svg(bearing), svg(attitude)}) + legend(range.series) +
          legend(objects.series) + figures(2, {svg(range), svg(objects)}) + gallery(record));
}

}  // namespace vbar::report
