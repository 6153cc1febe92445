#include <algorithm>
#include <array>
#include <cmath>
#include <map>
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

constexpr int kKeypoints = 11;

using Cells = std::vector<std::string>;

// ------------------------------------------------------------------------------------------------- table of the paper

Cells papers_row(const std::vector<WaypointRow>& waypoints, const char* loop, const paper2::Totals& totals,
                 paper2::Loop paper2::Loops::*which, bool is_navigation) {
  Cells cells{"", loop};
  for (const WaypointRow& row : waypoints) {
    const paper2::Loops* const same = at_waypoint(paper2::kWaypoints, row);
    std::optional<double> value;
    if (same != nullptr) value = is_navigation ? (same->*which).navigation_error_m : (same->*which).control_error_m;
    cells.push_back(fixed(value, 4));
  }
  cells.push_back(is_navigation ? plus_minus(totals.navigation_error_m, 4) : "");
  return cells;
}

/// The paper's figures are printed below those of a run that meets its waypoints.
std::string performance_table(const RunRecord& record) {
  const std::vector<WaypointRow> waypoints = reached_waypoints(record);
  std::vector<Column> columns{{"", false}, {"", false}};
  for (const WaypointRow& row : waypoints) columns.push_back({fmt::format("waypoint {}", row.index)});
  columns.push_back({"whole run"});
  const bool has_paper = meets_paper(paper2::kWaypoints, waypoints);
  std::vector<Cells> rows;
  for (const bool is_navigation : {true, false}) {
    Cells& own = rows.emplace_back(Cells{is_navigation ? "navigation error, m" : "control error, m", kThisRun});
    for (const WaypointRow& row : waypoints)
      own.push_back(fixed(is_navigation ? row.navigation_error_m : std::optional(row.control_error_m), 4));
    own.push_back(is_navigation ? plus_minus(record.summary.navigation_error_m, 4) : "");
    if (!has_paper) continue;
    rows.push_back(papers_row(waypoints, kPaperSoftware, paper2::kSoftware, &paper2::Loops::software, is_navigation));
    rows.push_back(papers_row(waypoints, kPaperHardware, paper2::kHardware, &paper2::Loops::hardware, is_navigation));
  }
  /// A figure of the whole run, with those of the paper below it.
  const auto totals = [&](const char* name, const std::string& run, const auto& of_paper) {
    const auto total = [&](const char* first, const char* of, const std::string& value) {
      Cells& cells = rows.emplace_back(Cells{first, of});
      cells.resize(2 + waypoints.size());
      cells.push_back(value);
    };
    total(name, kThisRun, run);
    if (!has_paper) return;
    total("", kPaperSoftware, of_paper(paper2::kSoftware));
    total("", kPaperHardware, of_paper(paper2::kHardware));
  };
  const auto dv = [](double mps, int maneuvers) {
    return fmt::format("{} in {} maneuvers", fixed(1e3 * mps, 2), maneuvers);
  };
  const Summary& s = record.summary;
  totals("attitude error, deg", plus_minus(s.attitude_error_deg, 2),
         [](const paper2::Totals& paper) { return plus_minus(paper.attitude_error_deg, 2); });
  totals("delta-v, mm/s", dv(s.dv_mps, s.maneuvers),
         [&](const paper2::Totals& paper) { return dv(paper.dv_mps, paper.maneuvers); });
  return table(columns, rows);
}

// ----------------------------------------------------------------------------------------------------------- in words

std::string percent(double part, double whole) {
  return whole > 0.0 ? fmt::format("{} %", fixed(100.0 * part / whole, 1)) : "–";
}

/// Over its degrees of freedom.
Fact nis_fact(const RunRecord& record) {
  double sum = 0.0;
  std::size_t degrees = 0;
  for (const PoseRow& row : record.tables.rows<PoseRow>()) {
    if (row.fate != telemetry_pose::kEditKeypoints || row.nis_degrees <= 0 || !std::isfinite(row.nis)) continue;
    sum += row.nis;
    degrees += static_cast<std::size_t>(row.nis_degrees);
  }
  const auto mean = degrees > 0 ? std::optional(sum / static_cast<double>(degrees)) : std::nullopt;
  return consistency_fact("NIS per degree of freedom, mean", mean, 1.0, degrees);
}

std::size_t count_of(const RunRecord& record, std::optional<double> PoseRow::*value) {
  return static_cast<std::size_t>(std::ranges::count_if(record.tables.rows<PoseRow>(),
                                                        [&](const PoseRow& row) { return (row.*value).has_value(); }));
}

std::string facts(const RunRecord& record) {
  const PoseFigures f = pose_figures(record).value_or(PoseFigures{});
  const PoseRow& last = record.tables.rows<PoseRow>().back();
  return fact_list(
      {{"images", fmt::format("{}, {} ({}) with a PnP pose, {} of them with an attitude error over 10 deg", f.images,
                              f.with_pose, percent(f.with_pose, f.images), f.poses_over_10_deg)},
       {"images in navigation", fmt::format("{} used, {} rejected", last.images_used, last.images_refused)},
       {"keypoints in navigation", fmt::format("{} used, {} rejected", last.keypoints_used, last.keypoints_refused)},
       {"keypoint error, median", fmt::format("{} px", fixed(f.keypoint_error_px, 2))},
       {"normalised squared keypoint error, median", fixed(f.keypoint_chi_square, 2) + ", 1.39 expected"},
       nis_fact(record),
       consistency_fact("NEES of the orbit, mean", record.summary.navigation_nees, 6.0,
                        count_of(record, &PoseRow::nees)),
       consistency_fact("NEES of attitude and rate, mean", f.attitude_nees, 6.0,
                        count_of(record, &PoseRow::attitude_nees)),
       {"navigation error, target sunlit",
        f.lit_navigation_error_m.mean > 0.0 ? plus_minus(f.lit_navigation_error_m, 4) + " m" : std::string("–")},
       {"re-initialised", fmt::format("attitude {} times, the whole filter {} times", f.attitude_restarts, f.restarts)},
       {"image tiles rejected", std::to_string(last.tiles_refused)}});
}

/// Images by outcome.
std::string outcome_table(const RunRecord& record) {
  std::map<int, std::array<int, 4>> counts;  // counts of a status: all, rejected, used, kept for the initialisation
  for (const PoseRow& row : record.tables.rows<PoseRow>()) {
    std::array<int, 4>& count = counts[row.status];
    ++count[0];
    if (row.fate >= 1 && row.fate <= 3) ++count[static_cast<std::size_t>(row.fate)];
  }
  std::vector<Cells> rows;
  for (const auto& [status, count] : counts)
    rows.push_back({pose_sighting_name(status), std::to_string(count[0]), std::to_string(count[2]),
                    std::to_string(count[1]), std::to_string(count[3])});
  return table({{"outcome", false}, {"images"}, {"used"}, {"rejected"}, {"kept for initialisation"}}, rows);
}

double at_share(std::vector<double>& sorted, double share) {
  return sorted[std::min(sorted.size() - 1, static_cast<std::size_t>(share * static_cast<double>(sorted.size())))];
}

/// Table of the keypoints: shares of the images, errors.
std::string keypoint_table(const RunRecord& record) {
  struct Of {
    int images = 0, usable = 0, used = 0, refused = 0;
    std::vector<double> errors, sigmas;
  };
  std::array<Of, kKeypoints> of{};
  for (const KeypointRow& row : record.tables.rows<KeypointRow>()) {
    if (row.keypoint < 0 || row.keypoint >= kKeypoints) continue;
    Of& keypoint = of[static_cast<std::size_t>(row.keypoint)];
    ++keypoint.images;
    if (row.fate == telemetry_pose::kKeypointUnusable) continue;
    ++keypoint.usable;
    keypoint.refused += row.fate == telemetry_pose::kKeypointRejected ? 1 : 0;
    keypoint.used += row.fate == telemetry_pose::kKeypointUsed ? 1 : 0;
    if (!row.error_x_px || !row.error_y_px) continue;
    const double error = std::hypot(*row.error_x_px, *row.error_y_px);
    const double sigma = std::sqrt(0.5 * static_cast<double>(row.covariance_xx_px2 + row.covariance_yy_px2));
    if (!std::isfinite(error) || !std::isfinite(sigma)) continue;
    keypoint.errors.push_back(error);
    keypoint.sigmas.push_back(sigma);
  }
  std::vector<Cells> rows;
  for (std::size_t k = 0; k < of.size(); ++k) {
    Of& keypoint = of[k];
    Cells cells{std::to_string(k), percent(keypoint.usable, keypoint.images), percent(keypoint.used, keypoint.images),
                percent(keypoint.refused, keypoint.images)};
    std::ranges::sort(keypoint.errors);
    std::ranges::sort(keypoint.sigmas);
    for (const double share : {0.5, 0.95})
      cells.push_back(keypoint.errors.empty() ? "–" : fixed(at_share(keypoint.errors, share), 2));
    cells.push_back(keypoint.sigmas.empty() ? "–" : fixed(at_share(keypoint.sigmas, 0.5), 2));
    rows.push_back(std::move(cells));
  }
  return table(
      {{"keypoint"}, {"usable"}, {"used"}, {"rejected"}, {"error, px: median"}, {"95 %"}, {"1σ per axis, px: median"}},
      rows);
}

// --------------------------------------------------------------------------------------------------------------- plots

Plot empty_plot(const RunRecord& record, const View& view, std::string title, const char* quantity, Unit unit) {
  return time_plot(view, std::move(title), quantity, unit, 220.0, &record);
}

/// (hours, value(row)) of the images for which it gives one.
template <class Value>
std::vector<Point> points_of(const RunRecord& record, const Value& value) {
  std::vector<Point> points;
  for (const PoseRow& row : record.tables.rows<PoseRow>())
    if (const std::optional<double> one = value(row)) points.push_back({hours(row.time_s), *one});
  return points;
}

/// Sizes that all but `left_out` of the values stay below, with some room.
double most_of(const std::vector<Series>& series, double left_out) {
  std::vector<double> sizes;
  for (const Series& one : series)
    for (const Point& point : one.points)
      if (std::isfinite(point.y)) sizes.push_back(std::abs(point.y));
  if (sizes.empty()) return 1.0;
  std::ranges::sort(sizes);
  return std::max(1.2 * at_share(sizes, 1.0 - left_out), 1e-4);
}

/// Lines with a gap where the next image with a value is more than a minute away.
template <class Value>
std::vector<Point> line_of(const RunRecord& record, const Value& value) {
  constexpr double kGap_s = 60.0;
  std::vector<Point> points;
  for (const PoseRow& row : record.tables.rows<PoseRow>()) {
    const std::optional<double> one = value(row);
    if (!one) continue;
    if (!points.empty() && hours(row.time_s) - points.back().x > hours(kGap_s))
      points.push_back({points.back().x, std::nan("")});
    points.push_back({hours(row.time_s), *one});
  }
  return points;
}

/// Standard deviation of the rotation about a body axis, as the filter states it; rad.
double attitude_sigma(const PoseRow& row, std::size_t axis) {
  constexpr std::array<std::size_t, 3> kDiagonal{0, 2, 5};
  return std::sqrt(std::max(row.covariance_attitude[kDiagonal[axis]], 0.0));
}

Plot attitude_plot(const RunRecord& record, const View& view) {
  Plot plot = empty_plot(record, view, "Total attitude error", "angle", Unit::kRadians);
  plot.y.logarithmic = true;
  plot.series = {
      {"estimate minus truth", 0, Mark::kLine,
       line_of(record,
               [](const PoseRow& row) -> std::optional<double> {
                 if (!row.attitude_error_deg) return std::nullopt;
                 return fsw::math::kDegree * *row.attitude_error_deg;
               })},
      {"3σ of the filter", 1, Mark::kDashedLine, line_of(record, [](const PoseRow& row) -> std::optional<double> {
         if (!row.attitude_error_deg) return std::nullopt;
         return 3.0 * magnitude({attitude_sigma(row, 0), attitude_sigma(row, 1), attitude_sigma(row, 2)});
       })}};
  return plot;
}

std::vector<Plot> attitude_component_plots(const RunRecord& record, const View& view) {
  constexpr std::array<const char*, 3> kAxes{"x", "y", "z"};
  constexpr std::array<std::optional<double> PoseRow::*, 3> kErrors{
      &PoseRow::attitude_error_x_deg, &PoseRow::attitude_error_y_deg, &PoseRow::attitude_error_z_deg};
  std::vector<Plot> plots;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Plot plot =
        empty_plot(record, view, fmt::format("Attitude error about body {}", kAxes[axis]), "angle", Unit::kRadians);
    const auto error = [&](const PoseRow& row) -> std::optional<double> {
      const std::optional<double>& deg = row.*kErrors[axis];
      return deg ? std::optional(fsw::math::kDegree * *deg) : std::nullopt;
    };
    const auto bound = [&](double sigmas) {
      return line_of(record, [&, sigmas](const PoseRow& row) -> std::optional<double> {
        return row.*kErrors[axis] ? std::optional(sigmas * attitude_sigma(row, axis)) : std::nullopt;
      });
    };
    plot.series = {{"estimate minus truth", 0, Mark::kLine, line_of(record, error)},
                   {"3σ of the filter", 1, Mark::kDashedLine, bound(3.0)},
                   {"", 1, Mark::kDashedLine, bound(-3.0)}};
    const double most = most_of(plot.series, 0.02);
    plot.y.range = Range{-most, most};
    plots.push_back(std::move(plot));
  }
  return plots;
}

Plot rate_plot(const RunRecord& record, const View& view) {
  Plot plot = empty_plot(record, view, "Error of the target's angular rate", "rate", Unit::kRadiansPerSecond);
  plot.y.logarithmic = true;
  plot.series = {{"", 0, Mark::kLine, line_of(record, [](const PoseRow& row) { return row.rate_error_radps; })}};
  return plot;
}

std::vector<Plot> pnp_plots(const RunRecord& record, const View& view) {
  constexpr std::array<const char*, 3> kTitles{"PnP position error, camera x", "PnP position error, camera y",
                                               "PnP position error, boresight"};
  constexpr std::array<std::optional<double> PoseRow::*, 3> kErrors{&PoseRow::pnp_error_x_m, &PoseRow::pnp_error_y_m,
                                                                    &PoseRow::pnp_error_z_m};
  std::vector<Plot> plots;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Plot plot = empty_plot(record, view, kTitles[axis], "error", Unit::kMetres);
    plot.series = {{"", 5, Mark::kDots, points_of(record, [&](const PoseRow& row) { return row.*kErrors[axis]; })}};
    const double most = most_of(plot.series, 0.02);
    plot.y.range = Range{-most, most};
    plots.push_back(std::move(plot));
  }
  Plot angle = empty_plot(record, view, "PnP attitude error", "angle", Unit::kRadians);
  angle.y.logarithmic = true;
  angle.series = {{"", 5, Mark::kDots, points_of(record, [](const PoseRow& row) -> std::optional<double> {
                     return row.pnp_error_deg ? std::optional(fsw::math::kDegree * *row.pnp_error_deg) : std::nullopt;
                   })}};
  plots.push_back(std::move(angle));
  return plots;
}

Plot range_plot(const RunRecord& record, const View& view) {
  Plot plot = empty_plot(record, view, "True range", "range", Unit::kMetres);
  plot.series = {{"", 2, Mark::kLine, points_of(record, [](const PoseRow& row) { return row.range_m; })}};
  return plot;
}

Plot keypoint_count_plot(const RunRecord& record, const View& view) {
  Plot plot = empty_plot(record, view, "Keypoints per image", "keypoints", Unit::kNone);
  std::map<std::int32_t, std::pair<int, int>> counts;  // counts of an image: usable, used
  for (const KeypointRow& row : record.tables.rows<KeypointRow>()) {
    counts[row.image].first += row.fate != telemetry_pose::kKeypointUnusable ? 1 : 0;
    counts[row.image].second += row.fate == telemetry_pose::kKeypointUsed ? 1 : 0;
  }
  const auto count = [&](auto which) {
    return points_of(record, [&](const PoseRow& row) {
      const auto found = counts.find(row.image);
      return found == counts.end() ? std::nullopt : std::optional<double>(found->second.*which);
    });
  };
  plot.series = {{"usable", 5, Mark::kDots, count(&std::pair<int, int>::first)},
                 {"used", 0, Mark::kDots, count(&std::pair<int, int>::second)}};
  plot.y.range = Range{0.0, kKeypoints + 0.5};
  return plot;
}

/// Squared errors over what the covariances claim, by what share of the keypoints is below: beside chi-square.
Plot consistency_plot(const RunRecord& record) {
  std::vector<double> squares;
  for (const KeypointRow& row : record.tables.rows<KeypointRow>()) {
    if (!row.error_x_px || !row.error_y_px) continue;
    const double xx = row.covariance_xx_px2, xy = row.covariance_xy_px2, yy = row.covariance_yy_px2;
    const double determinant = xx * yy - xy * xy;
    if (!(determinant > 0.0)) continue;
    const double x = *row.error_x_px, y = *row.error_y_px;
    const double square = (yy * x * x - 2.0 * xy * x * y + xx * y * y) / determinant;
    if (std::isfinite(square)) squares.push_back(square);
  }
  std::ranges::sort(squares);
  Plot plot;
  plot.title = "Normalised squared keypoint errors";
  constexpr double kMost = 15.0, kStep = 0.1;
  plot.x = {.name = "squared error over reported variance", .range = Range{0.0, kMost}};
  plot.y = {.name = "cumulative share of keypoints", .range = Range{0.0, 1.0}};
  Series measured{"keypoints of this run", 0, Mark::kLine, {}},
      expected{"chi-square, two degrees of freedom", 1, Mark::kDashedLine, {}};
  for (double square = 0.0; square <= kMost; square += kStep) {
    const auto below = std::ranges::upper_bound(squares, square) - squares.begin();
    if (!squares.empty())
      measured.points.push_back({square, static_cast<double>(below) / static_cast<double>(squares.size())});
    expected.points.push_back({square, 1.0 - std::exp(-0.5 * square)});
  }
  plot.series = {std::move(measured), std::move(expected)};
  return plot;
}

// ------------------------------------------------------------------------------------------------------------- gallery

/// The crop in the image, and the keypoints in the enlarged crop with ellipses of three sigma.
std::string marks(const RunRecord& record, const GalleryImage& image) {
  constexpr double kCross = 5.0, kSigmas = 3.0;
  const auto pose = std::ranges::find(record.tables.rows<PoseRow>(), image.image, &PoseRow::image);
  if (pose == record.tables.rows<PoseRow>().end() || image.crop_side == 0 || !(pose->region_px[2] > 0.0)) return {};
  const auto [centre_x, centre_y, side] = pose->region_px;
  std::string all = box_mark({in_picture(centre_x, image.origin_x_px), in_picture(centre_y, image.origin_y_px), "green",
                              "crop for the network"},
                             0.5 * side);
  const double scale = image.crop_side / side;
  for (const KeypointRow& row : record.tables.rows<KeypointRow>()) {
    if (row.image != image.image || row.fate == 0) continue;
    MarkAt at{image.crop_left + scale * (static_cast<double>(row.x_px) - centre_x + 0.5 * side),
              scale * (static_cast<double>(row.y_px) - centre_y + 0.5 * side), row.fate == 1 ? "red" : "white",
              fmt::format("keypoint {}, {}", row.keypoint, row.fate == 1 ? "rejected" : "used")};
    if (row.error_x_px && row.error_y_px)
      at.tooltip += fmt::format(", error {} px", fixed(std::hypot(*row.error_x_px, *row.error_y_px), 2));
    const Triple covariance{row.covariance_xx_px2, row.covariance_xy_px2, row.covariance_yy_px2};
    all += cross_mark(at, kCross) + ellipse_mark(at, covariance, kSigmas * scale);
  }
  return all;
}

}  // namespace

report::Section pose_section(const report::RunRecord& record) {
  if (record.tables.rows<PoseRow>().empty()) return {};
  const View view = whole_run(record);
  std::vector<std::string> files{"poses.csv"};
  if (!record.tables.rows<KeypointRow>().empty()) files.emplace_back("keypoints.csv");
  if (!record.gallery.empty()) files.emplace_back("gallery.csv");
  return {
      "Navigation by the pose network",
      performance_table(record) + facts(record) + kBandNote + outcome_table(record) +
          "<h3>Attitude</h3>\n<p class=\"note\">Gaps: target in eclipse. Linear plots leave out the largest fiftieth "
          "of their values.</p>\n" +
          kPlotNote + plot_rows(3, {attitude_plot(record, view), rate_plot(record, view), range_plot(record, view)}) +
          plot_rows(3, attitude_component_plots(record, view)) + "<h3>Poses of single images</h3>\n" +
          plot_rows(4, pnp_plots(record, view)) + "<h3>Keypoints</h3>\n" + keypoint_table(record) +
          plot_rows(2, {keypoint_count_plot(record, view), consistency_plot(record)}) +
          gallery_html(record, 2,
                       "Left: as received by the flight software, with the crop. Right: the crop as the network "
                       "sees it, with one heatmap per keypoint in its colour. Crosses: keypoints, white if "
                       "navigation used them, red if it rejected them, with ellipses of 3σ.",
                       [&](const GalleryImage& image) { return marks(record, image); }),
      files};
}

}  // namespace vbar::sensors
