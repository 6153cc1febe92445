#include "host_sim/report/summarise.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "host_sim/report/csv_table.h"
#include "host_sim/report/extension.h"
#include "host_sim/report/maneuver_series.h"
#include "host_sim/report/navigation_errors.h"
#include "host_sim/report/statistics.h"

namespace vbar::report {
namespace {

/// The target, 0.7 m, is a pixel of 35 arcsec there.
constexpr double kUnresolvedRange_m = 5000.0;
constexpr double kLargePoseError_deg = 10.0;

std::optional<double> mean_of(const std::vector<double>& values) {
  return values.empty() ? std::nullopt : std::optional(statistics(values).mean);
}

std::optional<MeanAndDeviation> statistics_of(const std::vector<double>& values) {
  return values.empty() ? std::nullopt : std::optional(statistics(values));
}

/// NaN if any value is: it has no place in an order.
double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  if (std::ranges::any_of(values, [](double value) { return std::isnan(value); })) return std::nan("");
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

// Statistics of carrier-phase navigation are those after the first fix, as the paper's are.
void summarise_navigation(const RunRecord& record, Summary& summary) {
  const std::optional<double> fix_s = first_fix(record);
  std::vector<double> position_errors, velocity_errors, nees;
  for (const NavigationError& error : navigation_errors(record)) {
    if (fix_s && error.time_s < *fix_s) continue;
    position_errors.push_back(magnitude(error.position_rtn));
    velocity_errors.push_back(magnitude(error.velocity_rtn));
    if (error.nees) nees.push_back(*error.nees);
  }
  summary.first_fix_s = fix_s && !record.truth.empty() ? std::optional(*fix_s - record.truth.front().time_s) : fix_s;
  summary.navigation_nees = mean_of(nees);
  summary.navigation_error_m = statistics_of(position_errors);
  summary.navigation_velocity_error_mps = statistics_of(velocity_errors);
}

void summarise_maneuvers(const RunRecord& record, Summary& summary) {
  summary.dv_mps = 0.0;
  summary.maneuvers = 0;
  for (const ManeuverRow& maneuver : record.maneuvers) {
    if (!maneuver.accepted) continue;
    summary.dv_mps += magnitude(maneuver.executed_dv_rtn_mps);
    ++summary.maneuvers;
  }
}

void summarise_images(const RunRecord& record, Summary& summary) {
  if (record.images.empty() || summary.target.empty()) return;
  ImageCounts counts;
  counts.images = static_cast<int>(record.images.size());
  std::vector<double> x, y, size, across, all_nees;
  for (const ImageRow& row : record.images) {
    if (row.status == telemetry_image::kStatusBearing) ++counts.with_bearing;
    if (!row.range_m) ++counts.without_truth;
    if (!row.chosen.empty() && row.chosen != summary.target) ++counts.wrong_targets;
    if (row.attitude_error_across_arcsec) across.push_back(*row.attitude_error_across_arcsec);
    if (row.nees) all_nees.push_back(*row.nees);
    // A wrong choice is counted as one; its bearing says nothing of the target's.
    if (!row.bearing_error_x_arcsec || row.chosen != summary.target || !(row.range_m > kUnresolvedRange_m)) continue;
    x.push_back(*row.bearing_error_x_arcsec);
    y.push_back(row.bearing_error_y_arcsec.value_or(0.0));
    size.push_back(std::hypot(x.back(), y.back()));
  }
  summary.images = counts;
  summary.star_attitude_error_arcsec = statistics_of(across);
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

/// Position errors at the steps that told of an image of a lit target.
std::vector<double> lit_errors(const RunRecord& record) {
  std::vector<double> errors;
  auto image = record.poses.begin();
  for (const NavigationError& error : navigation_errors(record)) {
    while (image != record.poses.end() && image->step_time_s < error.time_s) ++image;
    if (image != record.poses.end() && image->step_time_s == error.time_s && image->sunlit.value_or(0.0) > 0.0)
      errors.push_back(magnitude(error.position_rtn));
  }
  return errors;
}

void summarise_poses(const RunRecord& record, Summary& summary) {
  if (record.poses.empty()) return;
  PoseFigures figures;
  std::vector<double> attitude_errors, nees, attitude_nees, keypoint_errors, chi_squares;
  for (const PoseRow& row : record.poses) {
    ++figures.images;
    if (!row.range_m) ++figures.without_truth;
    if (row.pnp_inliers > 0) ++figures.with_pose;
    if (!(row.pnp_error_deg.value_or(0.0) <= kLargePoseError_deg)) ++figures.poses_over_10_deg;
    if (row.attitude_error_deg) attitude_errors.push_back(*row.attitude_error_deg);
    if (row.nees) nees.push_back(*row.nees);
    if (row.attitude_nees && row.fate == telemetry_pose::kEditKeypoints) attitude_nees.push_back(*row.attitude_nees);
  }
  for (const KeypointRow& row : record.keypoints) {
    if (!row.error_x_px) continue;
    keypoint_errors.push_back(std::hypot(*row.error_x_px, row.error_y_px.value_or(0.0)));
    chi_squares.push_back(chi_square(row));
  }
  figures.keypoint_error_px = median(keypoint_errors);
  figures.keypoint_chi_square = median(chi_squares);
  figures.lit_navigation_error_m = statistics_of(lit_errors(record)).value_or(MeanAndDeviation{});
  figures.attitude_nees = mean_of(attitude_nees);
  figures.attitude_restarts = record.poses.back().attitude_restarts;
  figures.restarts = record.poses.back().restarts;
  summary.pose = figures;
  summary.attitude_error_deg = statistics_of(attitude_errors);
  if (!nees.empty()) summary.navigation_nees = mean_of(nees);
}

/// What the flight computer's steps cost; in which unit is a fact.
void summarise_flight_steps(const RunRecord& record, Summary& summary) {
  Summary::FlightStep total;
  total.unit = summary.flight_step.unit;
  double sum = 0.0;
  for (const EstimateRow& row : record.estimates) {
    ++total.count;
    total.max = std::max(total.max, row.step_cost);
    total.stack_bytes_max = std::max(total.stack_bytes_max, row.stack_bytes);
    sum += static_cast<double>(row.step_cost);
  }
  if (total.count > 0) total.mean = sum / static_cast<double>(total.count);
  summary.flight_step = total;
}

}  // namespace

Summary summarise(const RunRecord& record) {
  Summary summary = record.summary;
  // A killed run did not say how long it was.
  if (!summary.complete && summary.simulated_s == 0.0 && !record.truth.empty())
    summary.simulated_s = record.truth.back().time_s - record.truth.front().time_s;
  summarise_navigation(record, summary);
  summarise_maneuvers(record, summary);
  summarise_images(record, summary);
  summarise_poses(record, summary);
  summarise_flight_steps(record, summary);
  summary.sensor_figures.clear();
  for (const Extension* extension : record.extensions)
    if (extension->summarise != nullptr) extension->summarise(record, summary);
  if (!record.of<telemetry_health>().empty()) summary.health = record.of<telemetry_health>().back().message;
  return summary;
}

// A burn belongs to the leg of the waypoint it was commanded for: the last burn of a fuel-optimal leg stands at the
// waypoint's own time and stops the arrival.
void evaluate(RunRecord& record) {
  const std::vector<NavigationError> errors = navigation_errors(record);
  double cumulative = 0.0;
  for (WaypointRow& waypoint : record.waypoints) {
    const auto error = std::ranges::find(errors, waypoint.time_s, &NavigationError::time_s);
    if (error != errors.end()) {
      waypoint.navigation_error_m = magnitude(error->position_rtn);
      waypoint.navigation_velocity_error_mps = magnitude(error->velocity_rtn);
    }
    waypoint.leg_dv_mps = 0.0;
    waypoint.leg_maneuvers = 0;
    for (const ManeuverRow& maneuver : record.maneuvers) {
      if (!maneuver.accepted || maneuver.waypoint_index != waypoint.index) continue;
      waypoint.leg_dv_mps += magnitude(maneuver.executed_dv_rtn_mps);
      ++waypoint.leg_maneuvers;
    }
    cumulative += waypoint.leg_dv_mps;
    waypoint.cumulative_dv_mps = cumulative;
  }
  record.summary = summarise(record);
}

std::string health_line(const telemetry_health& health) {
  std::string line;
  visit_fields(health, [&](const Field& field, const auto& value) {
    const std::string_view name = field.name;
    if (value == 0 || name == "step" || name == "packets_accepted") return;
    std::string words(name);
    std::ranges::replace(words, '_', ' ');
    line += line.empty() ? "" : ", ";
    line +=
        words + " " + (field.codes.count > 0 ? word_of(field.codes, static_cast<int>(value)) : std::to_string(value));
  });
  return line;
}

}  // namespace vbar::report
