#pragma once
// Rows of images beside the truth: angles-only navigation (images.csv, objects.csv) and navigation by the pose network
// (poses.csv, keypoints.csv).

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "fsw/packets/messages.h"
#include "host_sim/report/run_columns.h"

namespace vbar::sensors {

/// Telemetry of angles-only navigation on an image, and the truth at its exposure (images.csv, only if a run has such
/// navigation).
struct ImageRow : telemetry_image {
  ImageRow() : telemetry_image{} {}
  double time_s = 0.0;       ///< middle of the exposure, since the mission's epoch
  double step_time_s = 0.0;  ///< time of the step whose telemetry reported it
  // The truth. Errors are estimated less true; absent where the flight software gave nothing.
  int true_object = -1;  ///< index of the object that is the target; -1: none is, or it is unknown
  std::string chosen;    ///< the spacecraft that the choice really is, "nothing" if none; empty without a choice
  std::optional<double> range_m, sunlit;
  std::optional<double> bearing_error_x_arcsec, bearing_error_y_arcsec;  ///< against the centre of mass
  std::optional<double> attitude_error_across_arcsec,
      attitude_error_roll_arcsec;  ///< errors of the boresight, and about it
  std::optional<double> nees;  ///< NEES of the osculating ROE, six degrees of freedom; of images that the filter used
};

/// Kind that the flight software assigned to an object of an image (objects.csv).
struct ObjectRow {
  double time_s = 0.0;
  std::int32_t image = 0;
  int object = 0;  ///< brightest first
  int kind = 0;    ///< telemetry_objects::kKind...
  std::int32_t star = 0;
  float x_px = 0.0F, y_px = 0.0F;  ///< on the detector
};

/// Telemetry of navigation by the pose network on an image, and the truth at its exposure (poses.csv, only if a run has
/// such navigation). The keypoints are rows of their own.
struct PoseRow : telemetry_pose {
  PoseRow() : telemetry_pose{} {}
  double time_s = 0.0;       ///< middle of the exposure, since the mission's epoch
  double step_time_s = 0.0;  ///< time of the step whose telemetry reported it
  // The truth. Errors are estimated less true; absent where the flight software gave nothing.
  std::optional<double> range_m, sunlit;
  std::optional<double> pnp_error_x_m, pnp_error_y_m, pnp_error_z_m, pnp_error_deg;        ///< in camera axes
  std::optional<double> attitude_error_deg;                                                ///< in all
  std::optional<double> attitude_error_x_deg, attitude_error_y_deg, attitude_error_z_deg;  ///< about body axes
  std::optional<double> rate_error_radps;
  std::optional<double> nees,
      attitude_nees;  ///< NEES of osculating ROE, of attitude and rate: six degrees of freedom each
};

/// A keypoint of such an image (keypoints.csv).
struct KeypointRow {
  double time_s = 0.0;
  std::int32_t image = 0;
  int keypoint = 0;
  int fate = 0;  ///< telemetry_pose::kKeypoint...
  float peak = 0.0F;
  float x_px = 0.0F, y_px = 0.0F;  ///< on the detector
  float covariance_xx_px2 = 0.0F, covariance_xy_px2 = 0.0F, covariance_yy_px2 = 0.0F;
  std::optional<double> error_x_px, error_y_px;
};

template <report::columns::RowOf<ImageRow> Row, class Visitor>
void visit_columns(Row& row, Visitor& visit) {
  visit(report::ColumnName{"time_s", "s, since the epoch of the mission: middle of the exposure"}, row.time_s);
  visit(report::ColumnName{"step_time_s", "s, since the epoch of the mission: of the step whose telemetry reported it"},
        row.step_time_s);
  report::columns::fields(visit, report::columns::message_of<telemetry_image>(row));
  visit(report::ColumnName{"true_object", "index of the object that is the target; -1: none is, or it is not known"},
        row.true_object);
  visit(report::ColumnName{"chosen",
                           "the spacecraft that the chosen object really is; nothing: none; empty without a choice"},
        row.chosen);
  visit(report::ColumnName{"range_m", "true, between centres of mass"}, row.range_m);
  visit(report::ColumnName{"sunlit", "true share of the Sun's disc that the target sees"}, row.sunlit);
  visit(report::ColumnName{"bearing_error_x_arcsec", "against the true centre of mass"}, row.bearing_error_x_arcsec);
  visit(report::ColumnName{"bearing_error_y_arcsec", "against the true centre of mass"}, row.bearing_error_y_arcsec);
  visit(report::ColumnName{"attitude_error_across_arcsec", "of the boresight"}, row.attitude_error_across_arcsec);
  visit(report::ColumnName{"attitude_error_roll_arcsec", "about the boresight"}, row.attitude_error_roll_arcsec);
  visit(report::ColumnName{"nees", "of the osculating ROE, six degrees of freedom; of images that the filter used"},
        row.nees);
}

template <report::columns::RowOf<ObjectRow> Row, class Visitor>
void visit_columns(Row& row, Visitor& visit) {
  visit(report::ColumnName{"time_s", "s, since the epoch of the mission: middle of the exposure"}, row.time_s);
  visit(report::ColumnName{"image", "number of the exposure"}, row.image);
  visit(report::ColumnName{"object", "brightest first"}, row.object);
  report::columns::coded(visit, "kind", "what the flight software took it for",
                         report::columns::words(codes::telemetry_objects_kKind), row.kind);
  visit(report::ColumnName{"star", "Hipparcos number, 0 none"}, row.star);
  visit(report::ColumnName{"x_px", "on the detector"}, row.x_px);
  visit(report::ColumnName{"y_px", "on the detector"}, row.y_px);
}

template <report::columns::RowOf<PoseRow> Row, class Visitor>
void visit_columns(Row& row, Visitor& visit) {
  visit(report::ColumnName{"time_s", "s, since the epoch of the mission: middle of the exposure"}, row.time_s);
  visit(report::ColumnName{"step_time_s", "s, since the epoch of the mission: of the step whose telemetry reported it"},
        row.step_time_s);
  report::columns::fields(visit, report::columns::message_of<telemetry_pose>(row), false);
  visit(report::ColumnName{"range_m", "true, between centres of mass"}, row.range_m);
  visit(report::ColumnName{"sunlit", "true share of the Sun's disc that the target sees"}, row.sunlit);
  visit(report::ColumnName{"pnp_error_x_m", "of the single-image pose, camera axes"}, row.pnp_error_x_m);
  visit(report::ColumnName{"pnp_error_y_m", "of the single-image pose, camera axes"}, row.pnp_error_y_m);
  visit(report::ColumnName{"pnp_error_z_m", "of the single-image pose, camera axes"}, row.pnp_error_z_m);
  visit(report::ColumnName{"pnp_error_deg", "angle of its attitude error"}, row.pnp_error_deg);
  visit(report::ColumnName{"attitude_error_deg", "angle of the attitude error of navigation"}, row.attitude_error_deg);
  visit(report::ColumnName{"attitude_error_x_deg", "about the body axis"}, row.attitude_error_x_deg);
  visit(report::ColumnName{"attitude_error_y_deg", "about the body axis"}, row.attitude_error_y_deg);
  visit(report::ColumnName{"attitude_error_z_deg", "about the body axis"}, row.attitude_error_z_deg);
  visit(report::ColumnName{"rate_error_radps", "magnitude"}, row.rate_error_radps);
  visit(report::ColumnName{"nees", "of the osculating ROE, six degrees of freedom"}, row.nees);
  visit(report::ColumnName{"attitude_nees", "of attitude and rate, six degrees of freedom"}, row.attitude_nees);
}

template <report::columns::RowOf<KeypointRow> Row, class Visitor>
void visit_columns(Row& row, Visitor& visit) {
  visit(report::ColumnName{"time_s", "s, since the epoch of the mission: middle of the exposure"}, row.time_s);
  visit(report::ColumnName{"image", "number of the exposure"}, row.image);
  visit(report::ColumnName{"keypoint", "index in the body file"}, row.keypoint);
  report::columns::coded(visit, "fate", "edit status", report::columns::words(codes::telemetry_pose_kKeypoint),
                         row.fate);
  visit(report::ColumnName{"peak", "fraction of the heatmap in its highest cells"}, row.peak);
  visit(report::ColumnName{"x_px", "on the detector"}, row.x_px);
  visit(report::ColumnName{"y_px", "on the detector"}, row.y_px);
  visit(report::ColumnName{"covariance_xx_px2", "of the place"}, row.covariance_xx_px2);
  visit(report::ColumnName{"covariance_xy_px2", "of the place"}, row.covariance_xy_px2);
  visit(report::ColumnName{"covariance_yy_px2", "of the place"}, row.covariance_yy_px2);
  visit(report::ColumnName{"error_x_px", "measured minus true"}, row.error_x_px);
  visit(report::ColumnName{"error_y_px", "measured minus true"}, row.error_y_px);
}

// Telemetry about images as rows of a record.

void append_objects(double exposure_s, const telemetry_objects& objects, std::vector<ObjectRow>& rows);

/// Appends the residuals of an image's bearing in the servicer's orbital plane and across it, in arcseconds, with the
/// standard deviation of the innovation along the residual vector: |prefit| / sqrt(NIS). None for a bearing of the
/// batch.
void append_residuals(const ImageRow& row, std::vector<report::ResidualRow>& rows);

}  // namespace vbar::sensors
