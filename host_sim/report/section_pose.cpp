#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "host_sim/report/code_names.h"
#include "host_sim/report/html_page.h"
#include "host_sim/report/image_png.h"
#include "host_sim/report/maneuver_series.h"
#include "host_sim/report/number_text.h"
#include "host_sim/report/paper_experiment2.h"
#include "host_sim/report/report_sections.h"
#include "host_sim/report/section_parts.h"
#include "host_sim/report/statistics.h"

namespace vbar::report {
namespace {

constexpr double kRadian = M_PI / 180.0;  // of a degree
constexpr int kKeypoints = 11;

// ------------------------------------------------------------------------------------------------- table of the paper

std::string plus_minus(const std::optional<MeanAndDeviation>& value, int decimals) {
  return value ? fmt::format("{} ± {}", fixed(value->mean, decimals), fixed(value->std, decimals)) : "–";
}

using Cells = std::vector<std::string>;

Cells papers_row(const RunRecord& record, const char* loop, const paper2::Totals& totals,
                 paper2::Loop paper2::Waypoint::*which, bool is_navigation) {
  Cells cells{"", loop};
  for (const WaypointRow& row : record.waypoints) {
    const paper2::Waypoint* const same = paper2::waypoint(row);
    std::optional<double> value;
    if (same != nullptr) value = is_navigation ? (same->*which).navigation_error_m : (same->*which).control_error_m;
    cells.push_back(fixed(value, 4));
  }
  cells.push_back(is_navigation ? plus_minus(totals.navigation_error_m, 4) : "");
  return cells;
}

/// The paper's numbers stand under those of a run that meets its waypoints.
std::string performance_table(const RunRecord& record) {
  std::vector<Column> columns{{"", false}, {"", false}};
  for (const WaypointRow& row : record.waypoints) columns.push_back({fmt::format("waypoint {}", row.index)});
  columns.push_back({"whole run"});
  const bool is_beside_the_paper =
      std::ranges::any_of(record.waypoints, [](const WaypointRow& row) { return paper2::waypoint(row) != nullptr; });
  std::vector<Cells> rows;
  for (const bool is_navigation : {true, false}) {
    Cells& own = rows.emplace_back(Cells{is_navigation ? "navigation error, m" : "control error, m", "this run"});
    for (const WaypointRow& row : record.waypoints)
      own.push_back(fixed(is_navigation ? row.navigation_error_m : std::optional(row.control_error_m), 4));
    own.push_back(is_navigation ? plus_minus(record.summary.navigation_error_m, 4) : "");
    if (!is_beside_the_paper) continue;
    rows.push_back(papers_row(record, "paper, software in the loop", paper2::kSoftware, &paper2::Waypoint::software,
                              is_navigation));
    rows.push_back(papers_row(record, "paper, hardware in the loop", paper2::kHardware, &paper2::Waypoint::hardware,
                              is_navigation));
  }
  const auto total = [&](const char* name, const char* of, const std::string& value) {
    Cells& cells = rows.emplace_back(Cells{name, of});
    cells.resize(2 + record.waypoints.size());
    cells.push_back(value);
  };
  const auto dv = [](double mps, int maneuvers) {
    return fmt::format("{} in {} maneuvers", fixed(1e3 * mps, 2), maneuvers);
  };
  const Summary& s = record.summary;
  total("attitude error, deg", "this run", plus_minus(s.attitude_error_deg, 2));
  if (is_beside_the_paper) {
    total("", "paper, software in the loop", plus_minus(paper2::kSoftware.attitude_error_deg, 2));
    total("", "paper, hardware in the loop", plus_minus(paper2::kHardware.attitude_error_deg, 2));
  }
  total("delta-v, mm/s", "this run", dv(s.dv_mps, s.maneuvers));
  if (is_beside_the_paper) {
    total("", "paper, software in the loop", dv(paper2::kSoftware.dv_mps, paper2::kSoftware.maneuvers));
    total("", "paper, hardware in the loop", dv(paper2::kHardware.dv_mps, paper2::kHardware.maneuvers));
  }
  return table(columns, rows);
}

// ----------------------------------------------------------------------------------------------------------- in words

std::string percent(double part, double whole) {
  return whole > 0.0 ? fmt::format("{} %", fixed(100.0 * part / whole, 1)) : "–";
}

/// Over its degrees of freedom: 1 is honest.
std::string nis_text(const RunRecord& record) {
  double sum = 0.0, degrees = 0.0;
  int images = 0;
  for (const PoseRow& row : record.poses) {
    if (row.fate != telemetry_pose::kEditKeypoints || row.nis_degrees <= 0 || !std::isfinite(row.nis)) continue;
    sum += row.nis;
    degrees += row.nis_degrees;
    ++images;
  }
  return images == 0 ? "–" : fmt::format("{}, over {} images", fixed(sum / degrees, 2), images);
}

std::string facts(const RunRecord& record) {
  const PoseFigures f = record.summary.pose.value_or(PoseFigures{});
  const PoseRow& last = record.poses.back();
  return fact_list(
      {{"images", fmt::format("{}, {} ({}) with a pose by PnP, {} of them more than 10 deg off", f.images, f.with_pose,
                              percent(f.with_pose, f.images), f.poses_over_10_deg)},
       {"images in navigation", fmt::format("{} used, {} refused", last.images_used, last.images_refused)},
       {"keypoints in navigation", fmt::format("{} used, {} refused", last.keypoints_used, last.keypoints_refused)},
       {"keypoint error, median", fmt::format("{} px", fixed(f.keypoint_error_px, 2))},
       {"normalised keypoint error squared, median; 1.39 expected", fixed(f.keypoint_chi_square, 2)},
       {"NIS over its degrees of freedom, 1 expected", nis_text(record)},
       {"NEES of the orbit, 6 expected", fixed(record.summary.navigation_nees, 2)},
       {"NEES of attitude and rate, 6 expected", fixed(f.attitude_nees, 2)},
       {"navigation error, target lit",
        f.lit_navigation_error_m.mean > 0.0 ? plus_minus(f.lit_navigation_error_m, 4) + " m" : std::string("–")},
       {"begun anew", fmt::format("attitude {} times, the whole filter {} times", f.attitude_restarts, f.restarts)},
       {"tiles refused", std::to_string(last.tiles_refused)}});
}

/// How many images came to what.
std::string outcome_table(const RunRecord& record) {
  std::map<int, std::array<int, 4>> counts;  // of a status: all, refused, folded in, kept for the start
  for (const PoseRow& row : record.poses) {
    std::array<int, 4>& count = counts[row.status];
    ++count[0];
    if (row.fate >= 1 && row.fate <= 3) ++count[static_cast<std::size_t>(row.fate)];
  }
  std::vector<Cells> rows;
  for (const auto& [status, count] : counts)
    rows.push_back({pose_sighting_name(status), std::to_string(count[0]), std::to_string(count[2]),
                    std::to_string(count[1]), std::to_string(count[3])});
  return table({{"what the images gave", false}, {"images"}, {"folded in"}, {"refused"}, {"kept for the start"}}, rows);
}

double at_share(std::vector<double>& sorted, double share) {
  return sorted[std::min(sorted.size() - 1, static_cast<std::size_t>(share * static_cast<double>(sorted.size())))];
}

/// Each keypoint: how often seen, used and refused, how far off.
std::string keypoint_table(const RunRecord& record) {
  struct Of {
    int images = 0, usable = 0, used = 0, refused = 0;
    std::vector<double> errors, sigmas;
  };
  std::array<Of, kKeypoints> of{};
  for (const KeypointRow& row : record.keypoints) {
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
  return table({{"keypoint"},
                {"usable"},
                {"used"},
                {"refused"},
                {"error, px: median"},
                {"95 %"},
                {"sigma of an axis, px: median"}},
               rows);
}

// --------------------------------------------------------------------------------------------------------------- plots

Plot empty_plot(const RunRecord& record, const View& view, std::string title, const char* quantity, Unit unit) {
  Plot plot;
  plot.title = std::move(title);
  plot.x = time_axis(view);
  plot.y = {.name = quantity, .unit = unit};
  plot.moments = waypoint_moments(view);
  plot.events = maneuver_events(record, view);
  return plot;
}

/// (hours, value(row)) of the images for which it gives one.
template <class Value>
std::vector<Point> points_of(const RunRecord& record, const Value& value) {
  std::vector<Point> points;
  for (const PoseRow& row : record.poses)
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
  for (const PoseRow& row : record.poses) {
    const std::optional<double> one = value(row);
    if (!one) continue;
    if (!points.empty() && hours(row.time_s) - points.back().x > hours(kGap_s))
      points.push_back({points.back().x, std::nan("")});
    points.push_back({hours(row.time_s), *one});
  }
  return points;
}

/// Of the turn about a body axis, as the filter claims; rad.
double attitude_sigma(const PoseRow& row, std::size_t axis) {
  constexpr std::array<std::size_t, 3> kDiagonal{0, 2, 5};
  return std::sqrt(std::max(row.covariance_attitude[kDiagonal[axis]], 0.0));
}

Plot attitude_plot(const RunRecord& record, const View& view) {
  Plot plot = empty_plot(record, view, "Attitude error, in all", "angle", Unit::kRadians);
  plot.y.logarithmic = true;
  plot.series = {{"estimated less true", 0, Mark::kLine,
                  line_of(record,
                          [](const PoseRow& row) -> std::optional<double> {
                            if (!row.attitude_error_deg) return std::nullopt;
                            return kRadian * *row.attitude_error_deg;
                          })},
                 {"three sigma as the filter claims", 1, Mark::kDashedLine,
                  line_of(record, [](const PoseRow& row) -> std::optional<double> {
                    if (!row.attitude_error_deg) return std::nullopt;
                    return 3.0 * std::hypot(attitude_sigma(row, 0), attitude_sigma(row, 1), attitude_sigma(row, 2));
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
    plot.height = 220.0;
    const auto error = [&](const PoseRow& row) -> std::optional<double> {
      const std::optional<double>& deg = row.*kErrors[axis];
      return deg ? std::optional(kRadian * *deg) : std::nullopt;
    };
    const auto bound = [&](double sigmas) {
      return line_of(record, [&, sigmas](const PoseRow& row) -> std::optional<double> {
        return row.*kErrors[axis] ? std::optional(sigmas * attitude_sigma(row, axis)) : std::nullopt;
      });
    };
    plot.series = {{"estimated less true", 0, Mark::kLine, line_of(record, error)},
                   {"three sigma as the filter claims", 1, Mark::kDashedLine, bound(3.0)},
                   {"", 1, Mark::kDashedLine, bound(-3.0)}};
    const double most = most_of(plot.series, 0.02);
    plot.y.range = Range{-most, most};
    plots.push_back(std::move(plot));
  }
  return plots;
}

Plot rate_plot(const RunRecord& record, const View& view) {
  Plot plot = empty_plot(record, view, "Error of the target's rate", "rate", Unit::kRadiansPerSecond);
  plot.y.logarithmic = true;
  plot.series = {{"size", 0, Mark::kLine, line_of(record, [](const PoseRow& row) { return row.rate_error_radps; })}};
  return plot;
}

std::vector<Plot> pnp_plots(const RunRecord& record, const View& view) {
  constexpr std::array<const char*, 3> kTitles{"PnP position error, camera x", "PnP position error, camera y",
                                               "PnP position error, along the boresight"};
  constexpr std::array<std::optional<double> PoseRow::*, 3> kErrors{&PoseRow::pnp_error_x_m, &PoseRow::pnp_error_y_m,
                                                                    &PoseRow::pnp_error_z_m};
  std::vector<Plot> plots;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Plot plot = empty_plot(record, view, kTitles[axis], "error", Unit::kMetres);
    plot.height = 220.0;
    plot.series = {{"", 5, Mark::kDots, points_of(record, [&](const PoseRow& row) { return row.*kErrors[axis]; })}};
    const double most = most_of(plot.series, 0.02);
    plot.y.range = Range{-most, most};
    plots.push_back(std::move(plot));
  }
  Plot angle = empty_plot(record, view, "PnP attitude error", "angle", Unit::kRadians);
  angle.y.logarithmic = true;
  angle.series = {{"", 5, Mark::kDots, points_of(record, [](const PoseRow& row) -> std::optional<double> {
                     return row.pnp_error_deg ? std::optional(kRadian * *row.pnp_error_deg) : std::nullopt;
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
  Plot plot = empty_plot(record, view, "Keypoints of an image", "keypoints", Unit::kNone);
  std::map<std::int32_t, std::pair<int, int>> counts;  // of an image: usable, used
  for (const KeypointRow& row : record.keypoints) {
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
                 {"folded in", 0, Mark::kDots, count(&std::pair<int, int>::second)}};
  plot.y.range = Range{0.0, kKeypoints + 0.5};
  return plot;
}

/// Squared errors over what the covariances claim, by what share of the keypoints is below: beside chi-square.
Plot consistency_plot(const RunRecord& record) {
  std::vector<double> squares;
  for (const KeypointRow& row : record.keypoints) {
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
  plot.title = "Normalised keypoint errors squared";
  constexpr double kMost = 15.0, kStep = 0.1;
  plot.x = {.name = "squared error over claimed variance", .range = Range{0.0, kMost}};
  plot.y = {.name = "share of keypoints below", .range = Range{0.0, 1.0}};
  Series measured{"keypoints of this run", 0, Mark::kLine, {}},
      expected{"two degrees of freedom", 1, Mark::kDashedLine, {}};
  for (double square = 0.0; square <= kMost; square += kStep) {
    const auto below = std::ranges::upper_bound(squares, square) - squares.begin();
    if (!squares.empty())
      measured.points.push_back({square, static_cast<double>(below) / static_cast<double>(squares.size())});
    expected.points.push_back({square, 1.0 - std::exp(-0.5 * square)});
  }
  plot.series = {std::move(measured), std::move(expected)};
  return plot;
}

std::vector<std::string> svgs(const std::vector<Plot>& plots) {
  std::vector<std::string> drawn;
  for (const Plot& plot : plots) drawn.push_back(svg(plot));
  return drawn;
}

// ------------------------------------------------------------------------------------------------------------- gallery

std::string gallery(const RunRecord& record) {
  if (record.gallery.empty()) return {};
  std::vector<std::string> pictures;
  for (const GalleryImage& image : record.gallery) {
    const std::string caption =
        fmt::format("image {} at {} h: {}", image.image, fixed(hours(image.time_s), 2), image.caption);
    pictures.push_back(fmt::format("<img class=\"picture\" alt=\"{0}\" src=\"{1}\"/><figcaption>{0}</figcaption>",
                                   escaped(caption), png_data_uri(image.png)));
  }
  return "<h3>Images</h3>\n<p class=\"note\">Left, as the flight software got it, with its crop. Right, the crop as "
         "the network saw it, with the network&#39;s maps, a colour a keypoint; crosses are the keypoints that came of "
         "them, white where navigation used them, red where it refused them, with ellipses of three sigma.</p>\n" +
         figures(1, pictures);
}

}  // namespace

std::string pose_section(const RunRecord& record) {
  if (record.poses.empty()) return {};
  const View view = whole_run(record);
  const Plot attitude = attitude_plot(record, view);
  const Plot counts = keypoint_count_plot(record, view), consistency = consistency_plot(record);
  return section(
      "Navigation by the pose network",
      performance_table(record) + facts(record) + outcome_table(record) +
          "<p class=\"note\">Dashed lines: waypoints. Strokes on the lower edge: maneuvers. Gaps: the target in the "
          "dark. Linear plots leave out the largest fiftieth of their values.</p>\n<h3>Attitude</h3>\n" +
          legend(attitude.series) + figures(3, svgs({attitude, rate_plot(record, view), range_plot(record, view)})) +
          figures(3, svgs(attitude_component_plots(record, view))) + "<h3>Poses of single images</h3>\n" +
          figures(4, svgs(pnp_plots(record, view))) + "<h3>Keypoints</h3>\n" + keypoint_table(record) +
          legend(counts.series) + legend(consistency.series) + figures(2, svgs({counts, consistency})) +
          gallery(record));
}

}  // namespace vbar::report
