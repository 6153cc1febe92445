// Experiment 1 beside the figures of the paper.

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "fsw/math/math.h"
#include "host_sim/report/plots/html_page.h"
#include "host_sim/report/plots/number_text.h"
#include "host_sim/report/published_figures.h"
#include "host_sim/report/run_series.h"
#include "host_sim/report/sections/gallery_html.h"
#include "host_sim/report/sections/sections.h"
#include "host_sim/report/statistics.h"
#include "host_sim/report/words.h"
#include "host_sim/sensors/camera/camera_report.h"

namespace vbar::sensors {

namespace {

using namespace report;  // NOLINT(google-build-using-namespace): a section is made of its parts

struct Metric {
  const char* name;
  std::function<std::optional<double>(const WaypointRow&)> value;
  double paper1::Loop::*papers_value;
};

const std::vector<Metric> kMetrics{
    {"navigation error, m", [](const WaypointRow& row) { return row.navigation_error_m; },
     &paper1::Loop::navigation_error_m},
    {"control error, m", [](const WaypointRow& row) { return row.control_error_m; }, &paper1::Loop::control_error_m}};

std::vector<std::string> papers_row(const std::vector<WaypointRow>& waypoints, const char* loop, const Metric& metric,
                                    paper1::Loop paper1::Loops::*which) {
  std::vector<std::string> cells{"", loop};
  for (const WaypointRow& row : waypoints) {
    const paper1::Loops* const same = at_waypoint(paper1::kWaypoints, row);
    cells.push_back(fixed(same != nullptr ? std::optional((same->*which).*metric.papers_value) : std::nullopt, 2));
  }
  return cells;
}

std::string text_of(const paper1::Totals& totals) {
  return fmt::format("{:.2f} in {} maneuvers", totals.dv_mps, totals.maneuvers);
}

}  // namespace

std::string angles_only_performance(const RunRecord& record) {
  const std::vector<WaypointRow> waypoints = reached_waypoints(record);
  std::vector<Column> columns{{"", false}, {"", false}};
  for (const WaypointRow& row : waypoints) columns.push_back({fmt::format("waypoint {}", row.index)});
  const bool has_paper = meets_paper(paper1::kWaypoints, waypoints);
  const std::string own = emulated_testbeds(record.summary).empty() ? kThisRun : "this run, emulated bench";
  std::vector<std::vector<std::string>> rows;
  for (const Metric& metric : kMetrics) {
    std::vector<std::string>& cells = rows.emplace_back(std::vector<std::string>{metric.name, own});
    for (const WaypointRow& row : waypoints) cells.push_back(fixed(metric.value(row), 2));
    if (!has_paper) continue;
    rows.push_back(papers_row(waypoints, kPaperSoftware, metric, &paper1::Loops::software));
    rows.push_back(papers_row(waypoints, kPaperHardware, metric, &paper1::Loops::hardware));
  }
  std::string out = waypoints.empty() ? "" : table(columns, rows);
  const Summary& s = record.summary;
  out += fmt::format("<p>Delta-v: {} m/s in {} maneuvers", fixed(s.dv_mps, 3), s.maneuvers);
  if (has_paper)
    out += fmt::format("; paper: {} (software in the loop) and {} (hardware in the loop)", text_of(paper1::kSoftware),
                       text_of(paper1::kHardware));
  return out + ".</p>\n";
}

namespace {

using fsw::math::kArcsecond;

// ----------------------------------------------------------------------------------------------------------- in words

/// The filter took the bearing, so that its residuals and its NIS are of this image.
bool is_filtered(const ImageRow& row) {
  return row.fate == telemetry_image::kEditFilter && std::isfinite(row.nis) && row.nis > 0.0;
}

Fact nis_fact(const RunRecord& record) {
  double sum = 0.0;
  std::size_t count = 0;
  for (const ImageRow& row : record.tables.rows<ImageRow>()) {
    if (!is_filtered(row)) continue;
    sum += row.nis;
    ++count;
  }
  return consistency_fact("NIS of a bearing, mean",
                          count > 0 ? std::optional(sum / static_cast<double>(count)) : std::nullopt, 2.0, count);
}

/// Number of identified stars of the images that had an attitude.
std::string stars_text(const RunRecord& record) {
  std::vector<int> stars;
  for (const ImageRow& row : record.tables.rows<ImageRow>())
    if (row.star_method != 0) stars.push_back(row.stars);
  if (stars.empty()) return "never";
  std::ranges::sort(stars);
  return fmt::format("{} to {}, median {}", stars.front(), stars.back(), stars[stars.size() / 2]);
}

std::string facts(const RunRecord& record) {
  const Summary& s = record.summary;
  const ImageCounts counts = image_counts(record).value_or(ImageCounts{});
  const ImageRow& last = record.tables.rows<ImageRow>().back();
  const auto with_nees = static_cast<std::size_t>(
      std::ranges::count_if(record.tables.rows<ImageRow>(), [](const ImageRow& row) { return row.nees.has_value(); }));
  std::vector<Fact> facts{{"images", fmt::format("{}, {} with a bearing, {} without stars", counts.images,
                                                 counts.with_bearing, last.images_without_stars)},
                          {"wrong target selected", fmt::format("{} of {} images with truth", counts.wrong_targets,
                                                                counts.images - counts.without_truth)},
                          {"lit target among the objects, without a bearing",
                           fmt::format("{} of {} images", counts.lit_not_found, counts.lit_among_objects)},
                          {"bearings", fmt::format("{} used, {} rejected", last.bearings_used, last.bearings_refused)},
                          {"stars per image", stars_text(record)},
                          nis_fact(record),
                          consistency_fact("NEES of the orbit, mean", s.navigation_nees, 6.0, with_nees),
                          {"image tiles rejected", std::to_string(last.tiles_refused)}};
  if (const auto& error = s.bearing_error_arcsec) {
    facts.push_back({"bearing error, target within a pixel", fmt::format("noise {} arcsec per axis, bias {} arcsec",
                                                                         fixed(error->std, 2), fixed(error->bias, 2))});
  }
  if (const auto& error = s.star_attitude_error_arcsec) {
    facts.push_back({"boresight error of the star attitude",
                     fmt::format("{} ± {} arcsec", fixed(error->mean, 2), fixed(error->std, 2))});
  }
  return fact_list(facts);
}

// --------------------------------------------------------------------------------------------------------------- plots

Plot empty_plot(const RunRecord& record, const View& view, const char* title, const char* quantity, Unit unit) {
  return time_plot(view, title, quantity, unit, 250.0, &record);
}

/// (hours, value(row)) of the images for which it gives one.
template <class Value>
std::vector<Point> points_of(const RunRecord& record, const View& view, const Value& value) {
  std::vector<Point> points;
  for (const ImageRow& row : record.tables.rows<ImageRow>()) {
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

constexpr std::array<const char*, 2> kPlanes{"in the orbital plane", "across the orbital plane"};

/// Two plots, of the two components.
std::vector<Plot> residual_plots(const RunRecord& record, const View& view) {
  std::vector<Plot> plots;
  for (const std::size_t axis : {0U, 1U}) {
    Plot plot = empty_plot(record, view, "", "residual", Unit::kArcseconds);
    plot.title = fmt::format("Bearing residual {}", kPlanes[axis]);
    const auto values = [&](double(telemetry_image::*residual)[2]) {
      return points_of(record, view, [&](const ImageRow& row) {
        return is_filtered(row) ? std::optional((row.*residual)[axis] / kArcsecond) : std::nullopt;
      });
    };
    plot.series = {{"prefit", 1, Mark::kBroadDots, values(&telemetry_image::prefit)},
                   {"postfit", 0, Mark::kDots, values(&telemetry_image::postfit)}};
    plot.y.range = range_of_most(plot.series);
    plots.push_back(std::move(plot));
  }
  return plots;
}

/// The prefit residual r over the standard deviation |r| / sqrt(NIS) of the innovation along it, by component. The
/// vector has the length sqrt(NIS), whatever the innovation's covariance.
std::vector<Plot> normalised_plots(const RunRecord& record, const View& view) {
  const double limit = std::sqrt(-2.0 * std::log(0.05));  // 95 % of chi-square with two degrees of freedom
  const Range across = hours_of(view);
  std::vector<Plot> plots;
  for (const std::size_t axis : {0U, 1U}) {
    Plot plot = empty_plot(record, view, "", "residual", Unit::kSigmas);
    plot.title = fmt::format("Normalised prefit residual {}", kPlanes[axis]);
    plot.series = {
        {"prefit", 1, Mark::kDots,
         points_of(record, view,
                   [&](const ImageRow& row) -> std::optional<double> {
                     if (!is_filtered(row)) return std::nullopt;
                     return row.prefit[axis] * std::sqrt(row.nis) / std::hypot(row.prefit[0], row.prefit[1]);
                   })},
        {"95 % of the residual vectors are shorter", 5, Mark::kDashedLine, {{across.low, limit}, {across.high, limit}}},
        {"", 5, Mark::kDashedLine, {{across.low, -limit}, {across.high, -limit}}}};
    plot.y.range = range_of_most(plot.series);
    plots.push_back(std::move(plot));
  }
  return plots;
}

/// On a logarithmic scale: the centre of brightness lies some decimetres beside the centre of mass, 1 arcsec at the
/// range of the first image and 300 at that of the last.
Plot bearing_error_plot(const RunRecord& record, const View& view) {
  Plot plot = empty_plot(record, view, "Error of the measured bearing", "error", Unit::kArcseconds);
  plot.y.logarithmic = true;
  const auto of_bearings = [&](const auto& value) {
    return points_of(record, view, [&](const ImageRow& row) {
      return row.bearing_error_x_arcsec ? std::optional<double>(value(row)) : std::nullopt;
    });
  };
  plot.series = {{"magnitude of the error", 0, Mark::kDots, of_bearings([](const ImageRow& row) {
                    return std::hypot(*row.bearing_error_x_arcsec, row.bearing_error_y_arcsec.value_or(0.0));
                  })},
                 {"1σ per axis reported with the bearing", 1, Mark::kDashedLine,
                  of_bearings([](const ImageRow& row) { return row.bearing_sigma / kArcsecond; })}};
  return plot;
}

Plot attitude_error_plot(const RunRecord& record, const View& view) {
  Plot plot = empty_plot(record, view, "Error of the star attitude", "error", Unit::kArcseconds);
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
  for (const ImageRow& row : record.tables.rows<ImageRow>())
    most = std::max({most, 1.0 * row.objects, 1.0 * row.stars});
  plot.y.range = from_zero_to(most);
  return plot;
}

/// Range is weakly observable from bearings alone.
Plot range_plot(const RunRecord& record, const View& view) {
  Plot plot = empty_plot(record, view, "Range, its error and 1σ of the filter", "range", Unit::kMetres);
  plot.y.logarithmic = true;
  Series truth{"true range", 2, Mark::kLine, {}}, error{"range error", 0, Mark::kLine, {}},
      sigma{"1σ of the filter along the line of sight", 1, Mark::kDashedLine, {}};
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

/// What the flight software took the objects of an image for; the target last, on top of its neighbours' marks.
std::string marks(const RunRecord& record, const GalleryImage& image) {
  constexpr double kRadius = 8.0;
  std::string all, target;
  for (const ObjectRow& row : record.tables.rows<ObjectRow>()) {
    if (row.image != image.image) continue;
    MarkAt at{in_picture(static_cast<double>(row.x_px), image.origin_x_px),
              in_picture(static_cast<double>(row.y_px), image.origin_y_px)};
    const std::string place = fmt::format("at x {:.1f}, y {:.1f} px", row.x_px, row.y_px);
    if (row.kind == 0) {
      at.colour = "blue";
      at.tooltip = "not matched, " + place;
      all += triangle_mark(at, kRadius);
    } else if (row.kind == 1) {
      at.tooltip = fmt::format("star HIP {}, {}", row.star, place);
      all += box_mark(at, kRadius);
    } else if (row.kind == 2) {
      at.colour = "green";
      at.tooltip = "selected target, " + place;
      target += circle_mark(at, image.target_radius_px);
    }
  }
  return all + target;
}

std::string gallery_note(const RunRecord& record) {
  std::string note =
      "As received by the flight software, with its findings: red boxes are identified stars, the green circle is the "
      "selected target, blue triangles are unmatched objects. Dark violet pixels did not arrive.";
  const auto has_twin = [](const GalleryImage& image) { return !image.difference.empty(); };
  if (std::ranges::any_of(record.gallery, has_twin))
    note +=
        " Beside an image of the testbed: the image that the digital twin makes of the same exposure, and their "
        "difference, red where the testbed's image is brighter, blue where the twin's is, black within five standard "
        "deviations of the noise. The bearing error in the twin's image follows from the centroids of target and stars "
        "in both images.";
  return note;
}

}  // namespace

report::Section angles_only_section(const report::RunRecord& record) {
  if (record.tables.rows<ImageRow>().empty()) return {};
  const View view = whole_run(record);
  std::vector<std::string> files{"images.csv"};
  if (!record.tables.rows<ObjectRow>().empty()) files.emplace_back("objects.csv");
  if (!record.gallery.empty()) files.emplace_back("gallery.csv");
  if (!record.residuals.empty()) files.emplace_back("residuals.csv");
  return {"Angles-only navigation",
          angles_only_performance(record) + facts(record) + kBandNote +
              "<p class=\"note\">Residuals of the bearings that the filter used. Normalised: over |prefit| / √NIS, the "
              "standard deviation of the innovation along the residual vector. Errors of bearings are against the "
              "target's centre of mass; its centre of brightness lies up to some decimetres beside it, which shows at "
              "close range. Linear plots leave out the largest hundredth of their dots.</p>\n" +
              kPlotNote + plot_rows(2, residual_plots(record, view)) + plot_rows(2, normalised_plots(record, view)) +
              plot_rows(2, {bearing_error_plot(record, view), attitude_error_plot(record, view)}) +
              plot_rows(2, {range_plot(record, view), objects_plot(record, view)}) +
              gallery_html(record, 3, gallery_note(record),
                           [&](const GalleryImage& image) { return marks(record, image); }),
          files};
}

}  // namespace vbar::sensors
