#include <algorithm>
#include <cmath>
#include <optional>

#include "host_sim/report/published_figures.h"
#include "host_sim/report/run_record.h"
#include "host_sim/report/run_series.h"
#include "host_sim/report/statistics.h"
#include "host_sim/sensors/camera/camera_report.h"
#include "host_sim/sensors/camera/camera_rows.h"

namespace vbar::sensors {

namespace {

using namespace report;  // NOLINT(google-build-using-namespace): figures are made of rows

/// The target, 0.7 m, is a pixel of 35 arcsec there.
constexpr double kUnresolvedRange_m = 5000.0;
constexpr double kLargePoseError_deg = 10.0;

/// NaN if any value is: it has no place in an order.
double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  if (std::ranges::any_of(values, [](double value) { return std::isnan(value); })) return std::nan("");
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

void summarise_angles_only(const RunRecord& record, Summary& summary) {
  const std::optional<ImageCounts> counts = image_counts(record);
  if (!counts) return;
  summary.sensor_figures["images"] = {{"images", counts->images},
                                      {"with_bearing", counts->with_bearing},
                                      {"with_stars", counts->with_stars},
                                      {"wrong_targets", counts->wrong_targets},
                                      {"without_truth", counts->without_truth},
                                      {"lit_among_objects", counts->lit_among_objects},
                                      {"lit_not_found", counts->lit_not_found}};
  if (summary.target.empty()) return;
  std::vector<double> x, y, size, across, all_nees;
  for (const ImageRow& row : record.tables.rows<ImageRow>()) {
    if (row.attitude_error_across_arcsec) across.push_back(*row.attitude_error_across_arcsec);
    if (row.nees) all_nees.push_back(*row.nees);
    // A wrong choice is counted as one; its bearing is not that of the target.
    if (!row.bearing_error_x_arcsec || row.chosen != summary.target || !(row.range_m > kUnresolvedRange_m)) continue;
    x.push_back(*row.bearing_error_x_arcsec);
    y.push_back(row.bearing_error_y_arcsec.value_or(0.0));
    size.push_back(std::hypot(x.back(), y.back()));
  }
  summary.star_attitude_error_arcsec = statistics_of(across);
  if (!all_nees.empty() && !record.truth.empty()) {
    const auto used =
        std::ranges::find_if(record.tables.rows<ImageRow>(), [](const ImageRow& row) { return !!row.nees; });
    summary.sensor_figures["images"]["acquired_s"] = used->time_s - record.truth.front().time_s;
    summary.sensor_figures["images"]["nees_max"] = *std::ranges::max_element(all_nees);
  }
  if (!all_nees.empty()) summary.navigation_nees = mean_of(all_nees);
  summary.bearing_error_arcsec.reset();
  if (size.empty()) return;
  const MeanAndDeviation of_x = statistics(x), of_y = statistics(y);
  summary.bearing_error_arcsec =
      BearingError{statistics(size).mean, std::hypot(of_x.std, of_y.std) / M_SQRT2, std::hypot(of_x.mean, of_y.mean)};
}

/// Error' covariance^-1 error of a keypoint.
double chi_square(const KeypointRow& row) {
  const double xx = row.covariance_xx_px2, xy = row.covariance_xy_px2, yy = row.covariance_yy_px2;
  const double ex = *row.error_x_px, ey = row.error_y_px.value_or(0.0);
  return (yy * ex * ex - 2.0 * xy * ex * ey + xx * ey * ey) / (xx * yy - xy * xy);
}

/// Position errors at the steps whose telemetry reported an image of a lit target.
std::vector<double> lit_errors(const RunRecord& record) {
  std::vector<double> errors;
  auto image = record.tables.rows<PoseRow>().begin();
  for (const NavigationError& error : navigation_errors(record)) {
    while (image != record.tables.rows<PoseRow>().end() && image->step_time_s < error.time_s) ++image;
    if (image != record.tables.rows<PoseRow>().end() && image->step_time_s == error.time_s &&
        image->sunlit.value_or(0.0) > 0.0)
      errors.push_back(magnitude(error.position_rtn));
  }
  return errors;
}

void summarise_poses(const RunRecord& record, Summary& summary) {
  const std::optional<PoseFigures> figures = pose_figures(record);
  if (!figures) return;
  summary.sensor_figures["pose"] = {{"images", figures->images},
                                    {"with_pose", figures->with_pose},
                                    {"poses_over_10_deg", figures->poses_over_10_deg},
                                    {"keypoint_error_px", figures->keypoint_error_px},
                                    {"keypoint_chi_square", figures->keypoint_chi_square},
                                    {"lit_navigation_error_mean_m", figures->lit_navigation_error_m.mean},
                                    {"lit_navigation_error_std_m", figures->lit_navigation_error_m.std},
                                    {"attitude_restarts", figures->attitude_restarts},
                                    {"restarts", figures->restarts},
                                    {"without_truth", figures->without_truth}};
  if (figures->attitude_nees) summary.sensor_figures["pose"]["attitude_nees"] = *figures->attitude_nees;
  constexpr double kClose_m = 50.0;  // from here on keypoints resolve the attitude in every view
  std::vector<double> attitude_errors, close_attitude_errors, nees;
  for (const PoseRow& row : record.tables.rows<PoseRow>()) {
    if (row.attitude_error_deg) attitude_errors.push_back(*row.attitude_error_deg);
    if (row.attitude_error_deg && row.range_m && *row.range_m <= kClose_m)
      close_attitude_errors.push_back(*row.attitude_error_deg);
    if (row.nees) nees.push_back(*row.nees);
  }
  summary.attitude_error_deg = statistics_of(attitude_errors);
  if (!close_attitude_errors.empty()) {
    std::ranges::sort(close_attitude_errors);
    summary.sensor_figures["pose"]["close_attitude_error_median_deg"] = quantile(close_attitude_errors, 0.5);
  }
  if (!nees.empty()) summary.navigation_nees = mean_of(nees);
}

}  // namespace

std::optional<ImageCounts> image_counts(const RunRecord& record) {
  const std::vector<ImageRow>& images = record.tables.rows<ImageRow>();
  if (images.empty()) return std::nullopt;
  const std::string& target = record.summary.target;  // unknown in folders of earlier versions
  ImageCounts counts;
  counts.images = static_cast<int>(images.size());
  for (const ImageRow& row : images) {
    if (row.status == telemetry_image::kStatusBearing) ++counts.with_bearing;
    if (row.star_method != telemetry_image::kStarMethodNone) ++counts.with_stars;
    if (!row.range_m) ++counts.without_truth;
    if (!row.chosen.empty() && !target.empty() && row.chosen != target) ++counts.wrong_targets;
    if (row.true_object < 0 || !(row.sunlit.value_or(0.0) > 0.0)) continue;
    ++counts.lit_among_objects;
    if (row.status != telemetry_image::kStatusBearing) ++counts.lit_not_found;
  }
  return counts;
}

std::optional<PoseFigures> pose_figures(const RunRecord& record) {
  const std::vector<PoseRow>& poses = record.tables.rows<PoseRow>();
  if (poses.empty()) return std::nullopt;
  PoseFigures figures;
  std::vector<double> attitude_nees, keypoint_errors, chi_squares;
  for (const PoseRow& row : poses) {
    ++figures.images;
    if (!row.range_m) ++figures.without_truth;
    if (row.pnp_inliers > 0) ++figures.with_pose;
    if (!(row.pnp_error_deg.value_or(0.0) <= kLargePoseError_deg)) ++figures.poses_over_10_deg;
    if (row.attitude_nees && row.fate == telemetry_pose::kEditKeypoints) attitude_nees.push_back(*row.attitude_nees);
  }
  for (const KeypointRow& row : record.tables.rows<KeypointRow>()) {
    if (!row.error_x_px) continue;
    keypoint_errors.push_back(std::hypot(*row.error_x_px, row.error_y_px.value_or(0.0)));
    chi_squares.push_back(chi_square(row));
  }
  figures.keypoint_error_px = median(keypoint_errors);
  figures.keypoint_chi_square = median(chi_squares);
  figures.lit_navigation_error_m = statistics_of(lit_errors(record)).value_or(MeanAndDeviation{});
  figures.attitude_nees = mean_of(attitude_nees);
  figures.attitude_restarts = poses.back().attitude_restarts;
  figures.restarts = poses.back().restarts;
  return figures;
}

void summarise_images(const report::RunRecord& record, report::Summary& summary) {
  summarise_angles_only(record, summary);
  summarise_poses(record, summary);
}

using report::ConsistencyFigure;
using Kind = ConsistencyFigure::Kind;

std::vector<ConsistencyFigure> image_consistency(const report::RunRecord& record) {
  constexpr double kStates = 6.0, kBearing = 2.0;
  std::vector<ConsistencyFigure> figures;
  for (const ImageRow& row : record.tables.rows<ImageRow>()) {
    if (row.nees) figures.push_back({row.time_s, Kind::kNees, *row.nees, kStates});
    if (row.fate == telemetry_image::kEditFilter) figures.push_back({row.time_s, Kind::kNis, row.nis, kBearing});
  }
  for (const PoseRow& row : record.tables.rows<PoseRow>()) {
    if (row.nees) figures.push_back({row.time_s, Kind::kNees, *row.nees, kStates});
    if (row.fate == telemetry_pose::kEditKeypoints)
      figures.push_back({row.time_s, Kind::kNis, row.nis, static_cast<double>(row.nis_degrees)});
  }
  return figures;
}

// The paper's experiments 1 and 2 as columns of a comparison.

namespace {

template <class Waypoints, class Totals>
PaperColumn paper_column(const char* name, const Waypoints& waypoints, paper1::Loop paper1::Loops::*loop,
                         const Totals& totals) {
  PaperColumn column;
  column.name = name;
  column.at = [&waypoints, loop](const WaypointRow& row) {
    PaperColumn::AtWaypoint at;
    if (const paper1::Loops* const same = at_waypoint(waypoints, row)) {
      at.control_error_m = (same->*loop).control_error_m;
      at.navigation_error_m = (same->*loop).navigation_error_m;
    }
    return at;
  };
  column.dv_mps = totals.dv_mps;
  column.maneuvers = totals.maneuvers;
  return column;
}

PaperColumn paper_column(const char* name, paper1::Loop paper1::Loops::*loop, const paper2::Totals& totals) {
  PaperColumn column = paper_column(name, paper2::kWaypoints, loop, totals);
  column.navigation_error_m = totals.navigation_error_m;
  column.attitude_error_deg = totals.attitude_error_deg;
  return column;
}

}  // namespace

std::vector<PaperColumn> camera_paper_columns(const RunRecord& record) {
  const std::vector<WaypointRow> waypoints = reached_waypoints(record);
  const std::string& navigation = record.summary.navigation;
  if (navigation == "angles_only" && meets_paper(paper1::kWaypoints, waypoints))
    return {paper_column(kPaperSoftware, paper1::kWaypoints, &paper1::Loops::software, paper1::kSoftware),
            paper_column(kPaperHardware, paper1::kWaypoints, &paper1::Loops::hardware, paper1::kHardware)};
  if (navigation == "pose" && meets_paper(paper2::kWaypoints, waypoints))
    return {paper_column(kPaperSoftware, &paper1::Loops::software, paper2::kSoftware),
            paper_column(kPaperHardware, &paper1::Loops::hardware, paper2::kHardware)};
  return {};
}

}  // namespace vbar::sensors
