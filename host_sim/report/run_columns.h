#pragma once
// The columns of each file of a run folder, once for writing and reading alike: visit_columns(row, visitor) calls
// visitor(ColumnName, value) in the order of the file.

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <type_traits>

#include "host_sim/report/run_record.h"

namespace vbar::report {

/// `<group>_<member>`, or the group alone.
struct ColumnName {
  std::string_view group;
  std::string_view member{};

  [[nodiscard]] std::string text() const {
    std::string joined(group);
    if (!member.empty()) joined.append("_").append(member);
    return joined;
  }
};

namespace columns {

inline constexpr std::array<std::string_view, 3> kXyzM{"x_m", "y_m", "z_m"};
inline constexpr std::array<std::string_view, 3> kXyzMps{"x_mps", "y_mps", "z_mps"};
inline constexpr std::array<std::string_view, 3> kXyzRadps{"x_radps", "y_radps", "z_radps"};
inline constexpr std::array<std::string_view, 4> kWxyz{"w", "x", "y", "z"};
inline constexpr std::array<std::string_view, 3> kRtnM{"r_m", "t_m", "n_m"};
inline constexpr std::array<std::string_view, 3> kRtnMps{"r_mps", "t_mps", "n_mps"};
inline constexpr std::array<std::string_view, 6> kRtnMAndMps{"r_m", "t_m", "n_m", "r_mps", "t_mps", "n_mps"};
/// Rows and columns r, t, n, then their rates.
inline constexpr std::array<std::string_view, 21> kRtnLowerTriangle{
    "r_r",  "t_r",  "t_t",   "n_r",   "n_t",  "n_n",  "vr_r", "vr_t",  "vr_n",  "vr_vr", "vt_r",
    "vt_t", "vt_n", "vt_vr", "vt_vt", "vn_r", "vn_t", "vn_n", "vn_vr", "vn_vt", "vn_vn"};
inline constexpr std::array<std::string_view, 3> kXyz{"x", "y", "z"};
inline constexpr std::array<std::string_view, 2> kXyArcsec{"x_arcsec", "y_arcsec"};
/// Rows and columns da, dlambda, dex, dey, dix, diy.
inline constexpr std::array<std::string_view, 21> kRoeLowerTriangle{
    "da_da",   "dl_da",   "dl_dl",   "dex_da",  "dex_dl",  "dex_dex", "dey_da",
    "dey_dl",  "dey_dex", "dey_dey", "dix_da",  "dix_dl",  "dix_dex", "dix_dey",
    "dix_dix", "diy_da",  "diy_dl",  "diy_dex", "diy_dey", "diy_dix", "diy_diy"};
/// A square on the detector.
inline constexpr std::array<std::string_view, 3> kSquarePx{"x_px", "y_px", "side_px"};
/// Rows and columns turn about x, y, z (rad), rate about x, y, z (rad/s).
inline constexpr std::array<std::string_view, 21> kAttitudeLowerTriangle{
    "x_x",  "y_x",  "y_y",   "z_x",   "z_y",  "z_z",  "wx_x", "wx_y",  "wx_z",  "wx_wx", "wy_x",
    "wy_y", "wy_z", "wy_wx", "wy_wy", "wz_x", "wz_y", "wz_z", "wz_wx", "wz_wy", "wz_wz"};
inline constexpr std::array<std::string_view, 6> kRoeM{"da_m", "dlambda_m", "dex_m", "dey_m", "dix_m", "diy_m"};

template <class Visitor, class Values, std::size_t size>
void group(Visitor& visit, std::string_view name, const std::array<std::string_view, size>& members, Values& values) {
  static_assert(std::tuple_size_v<std::remove_const_t<Values>> == size);
  for (std::size_t k = 0; k < size; ++k) visit(ColumnName{name, members[k]}, values[k]);
}

/// `Row`, as a row that is written (const) or one that is read.
template <class Some, class Row>
concept RowOf = std::is_same_v<std::remove_const_t<Some>, Row>;

}  // namespace columns

template <columns::RowOf<TruthRow> Row, class Visitor>
void visit_columns(Row& row, Visitor& visit) {
  visit(ColumnName{"time_s"}, row.time_s);
  columns::group(visit, "servicer_position_eci", columns::kXyzM, row.servicer_position_eci);
  columns::group(visit, "servicer_velocity_eci", columns::kXyzMps, row.servicer_velocity_eci);
  columns::group(visit, "target_position_eci", columns::kXyzM, row.target_position_eci);
  columns::group(visit, "target_velocity_eci", columns::kXyzMps, row.target_velocity_eci);
  columns::group(visit, "relative_position_rtn", columns::kRtnM, row.relative_position_rtn);
  columns::group(visit, "relative_velocity_rtn", columns::kRtnMps, row.relative_velocity_rtn);
  columns::group(visit, "a_roe_mean", columns::kRoeM, row.a_roe_mean_m);
}

template <columns::RowOf<AttitudeRow> Row, class Visitor>
void visit_columns(Row& row, Visitor& visit) {
  visit(ColumnName{"time_s"}, row.time_s);
  visit(ColumnName{"spacecraft"}, row.spacecraft);
  columns::group(visit, "q_body_eci", columns::kWxyz, row.q_body_eci);
  columns::group(visit, "rate_body", columns::kXyzRadps, row.rate_body_radps);
}

template <columns::RowOf<EstimateRow> Row, class Visitor>
void visit_columns(Row& row, Visitor& visit) {
  visit(ColumnName{"time_s"}, row.time_s);
  visit(ColumnName{"step"}, row.step);
  visit(ColumnName{"navigation_source"}, row.navigation_source);
  visit(ColumnName{"navigation_valid"}, row.navigation_valid);
  columns::group(visit, "relative_position_rtn", columns::kRtnM, row.relative_position_rtn);
  columns::group(visit, "relative_velocity_rtn", columns::kRtnMps, row.relative_velocity_rtn);
  columns::group(visit, "sigma_rtn", columns::kRtnMAndMps, row.sigma_rtn);
  columns::group(visit, "a_roe_mean", columns::kRoeM, row.a_roe_mean_m);
  columns::group(visit, "a_roe_desired", columns::kRoeM, row.a_roe_desired_m);
  columns::group(visit, "predicted_a_roe_error", columns::kRoeM, row.predicted_a_roe_error_m);
  visit(ColumnName{"mode"}, row.mode);
  visit(ColumnName{"active_solver"}, row.active_solver);
  visit(ColumnName{"waypoint_index"}, row.waypoint_index);
  visit(ColumnName{"planned_burns"}, row.planned_burns);
  visit(ColumnName{"koenig_damico_status"}, row.koenig_damico_status);
  visit(ColumnName{"closed_form_status"}, row.closed_form_status);
  visit(ColumnName{"least_squares_status"}, row.least_squares_status);
  visit(ColumnName{"safety_status"}, row.safety_status);
  visit(ColumnName{"planned_dv_mps"}, row.planned_dv_mps);
  visit(ColumnName{"passive_safety_distance_m"}, row.passive_safety_distance_m);
  visit(ColumnName{"commanded_dv_mps"}, row.commanded_dv_mps);
  visit(ColumnName{"step_cost"}, row.step_cost);
  visit(ColumnName{"stack_bytes"}, row.stack_bytes);
}

template <columns::RowOf<GnssRow> Row, class Visitor>
void visit_columns(Row& row, Visitor& visit) {
  visit(ColumnName{"time_s"}, row.time_s);
  visit(ColumnName{"step"}, row.step);
  visit(ColumnName{"epoch_s"}, row.epoch_s);
  visit(ColumnName{"pairs"}, row.pairs);
  visit(ColumnName{"alone"}, row.alone);
  visit(ColumnName{"too_late"}, row.too_late);
  visit(ColumnName{"no_solution"}, row.no_solution);
  visit(ColumnName{"tracked"}, row.tracked);
  visit(ColumnName{"fixed"}, row.fixed);
  visit(ColumnName{"fixes"}, row.fixes);
  visit(ColumnName{"releases"}, row.releases);
  visit(ColumnName{"slips"}, row.slips);
  visit(ColumnName{"restarts"}, row.restarts);
  visit(ColumnName{"obstacle"}, row.obstacle);
  visit(ColumnName{"success_rate"}, row.success_rate);
  visit(ColumnName{"ratio"}, row.ratio);
  visit(ColumnName{"codes_used"}, row.codes_used);
  visit(ColumnName{"phases_used"}, row.phases_used);
  visit(ColumnName{"codes_refused"}, row.codes_refused);
  visit(ColumnName{"phases_refused"}, row.phases_refused);
  visit(ColumnName{"code_nis"}, row.code_nis);
  visit(ColumnName{"phase_nis"}, row.phase_nis);
  columns::group(visit, "covariance_rtn", columns::kRtnLowerTriangle, row.covariance_rtn);
  visit(ColumnName{"messages"}, row.messages);
  visit(ColumnName{"messages_refused"}, row.messages_refused);
}

template <columns::RowOf<ImageRow> Row, class Visitor>
void visit_columns(Row& row, Visitor& visit) {
  visit(ColumnName{"time_s"}, row.time_s);
  visit(ColumnName{"step_time_s"}, row.step_time_s);
  visit(ColumnName{"step"}, row.step);
  visit(ColumnName{"image"}, row.image);
  visit(ColumnName{"status"}, row.status);
  visit(ColumnName{"star_method"}, row.star_method);
  visit(ColumnName{"tiles_missing"}, row.tiles_missing);
  visit(ColumnName{"objects"}, row.objects);
  visit(ColumnName{"stars"}, row.stars);
  visit(ColumnName{"hypotheses"}, row.hypotheses);
  visit(ColumnName{"target_object"}, row.target_object);
  visit(ColumnName{"true_object"}, row.true_object);
  visit(ColumnName{"chosen"}, row.chosen);
  visit(ColumnName{"background_dn"}, row.background_dn);
  visit(ColumnName{"noise_dn"}, row.noise_dn);
  columns::group(visit, "q_eci_camera", columns::kWxyz, row.q_eci_camera);
  visit(ColumnName{"attitude_sigma_arcsec"}, row.attitude_sigma_arcsec);
  columns::group(visit, "bearing_eci", columns::kXyz, row.bearing_eci);
  visit(ColumnName{"bearing_sigma_arcsec"}, row.bearing_sigma_arcsec);
  columns::group(visit, "prefit", columns::kXyArcsec, row.prefit_arcsec);
  columns::group(visit, "postfit", columns::kXyArcsec, row.postfit_arcsec);
  visit(ColumnName{"nis"}, row.nis);
  visit(ColumnName{"used"}, row.used);
  columns::group(visit, "covariance_a_roe_m2", columns::kRoeLowerTriangle, row.covariance_a_roe_m2);
  columns::group(visit, "a_roe_osculating", columns::kRoeM, row.a_roe_osculating_m);
  visit(ColumnName{"bearings_used"}, row.bearings_used);
  visit(ColumnName{"bearings_refused"}, row.bearings_refused);
  visit(ColumnName{"images_without_stars"}, row.images_without_stars);
  visit(ColumnName{"tiles_refused"}, row.tiles_refused);
  visit(ColumnName{"range_m"}, row.range_m);
  visit(ColumnName{"bearing_error_x_arcsec"}, row.bearing_error_x_arcsec);
  visit(ColumnName{"bearing_error_y_arcsec"}, row.bearing_error_y_arcsec);
  visit(ColumnName{"attitude_error_across_arcsec"}, row.attitude_error_across_arcsec);
  visit(ColumnName{"attitude_error_roll_arcsec"}, row.attitude_error_roll_arcsec);
  visit(ColumnName{"nees"}, row.nees);
}

template <columns::RowOf<ObjectRow> Row, class Visitor>
void visit_columns(Row& row, Visitor& visit) {
  visit(ColumnName{"time_s"}, row.time_s);
  visit(ColumnName{"image"}, row.image);
  visit(ColumnName{"object"}, row.object);
  visit(ColumnName{"kind"}, row.kind);
  visit(ColumnName{"star"}, row.star);
  visit(ColumnName{"x_px"}, row.x_px);
  visit(ColumnName{"y_px"}, row.y_px);
}

template <columns::RowOf<PoseRow> Row, class Visitor>
void visit_columns(Row& row, Visitor& visit) {
  visit(ColumnName{"time_s"}, row.time_s);
  visit(ColumnName{"step_time_s"}, row.step_time_s);
  visit(ColumnName{"step"}, row.step);
  visit(ColumnName{"image"}, row.image);
  visit(ColumnName{"status"}, row.status);
  visit(ColumnName{"region_is_predicted"}, row.region_is_predicted);
  visit(ColumnName{"fate"}, row.fate);
  visit(ColumnName{"filter_runs"}, row.filter_runs);
  visit(ColumnName{"has_attitude"}, row.has_attitude);
  visit(ColumnName{"tiles_missing"}, row.tiles_missing);
  columns::group(visit, "region", columns::kSquarePx, row.region_px);
  visit(ColumnName{"pnp_inliers"}, row.pnp_inliers);
  columns::group(visit, "pnp_q_camera_body", columns::kWxyz, row.pnp_q_camera_body);
  columns::group(visit, "pnp_position_camera", columns::kXyzM, row.pnp_position_camera_m);
  visit(ColumnName{"pnp_mean_square"}, row.pnp_mean_square);
  columns::group(visit, "q_camera_body", columns::kWxyz, row.q_camera_body);
  columns::group(visit, "position_camera", columns::kXyzM, row.position_camera_m);
  columns::group(visit, "rate_body", columns::kXyzRadps, row.rate_body_radps);
  columns::group(visit, "covariance_attitude", columns::kAttitudeLowerTriangle, row.covariance_attitude);
  columns::group(visit, "covariance_a_roe_m2", columns::kRoeLowerTriangle, row.covariance_a_roe_m2);
  columns::group(visit, "a_roe_osculating", columns::kRoeM, row.a_roe_osculating_m);
  visit(ColumnName{"nis"}, row.nis);
  visit(ColumnName{"nis_degrees"}, row.nis_degrees);
  visit(ColumnName{"acceleration_psd"}, row.acceleration_psd);
  visit(ColumnName{"images_used"}, row.images_used);
  visit(ColumnName{"images_refused"}, row.images_refused);
  visit(ColumnName{"keypoints_used"}, row.keypoints_used);
  visit(ColumnName{"keypoints_refused"}, row.keypoints_refused);
  visit(ColumnName{"attitude_restarts"}, row.attitude_restarts);
  visit(ColumnName{"restarts"}, row.restarts);
  visit(ColumnName{"tiles_refused"}, row.tiles_refused);
  visit(ColumnName{"range_m"}, row.range_m);
  visit(ColumnName{"sunlit"}, row.sunlit);
  visit(ColumnName{"pnp_error_x_m"}, row.pnp_error_x_m);
  visit(ColumnName{"pnp_error_y_m"}, row.pnp_error_y_m);
  visit(ColumnName{"pnp_error_z_m"}, row.pnp_error_z_m);
  visit(ColumnName{"pnp_error_deg"}, row.pnp_error_deg);
  visit(ColumnName{"attitude_error_deg"}, row.attitude_error_deg);
  visit(ColumnName{"attitude_error_x_deg"}, row.attitude_error_x_deg);
  visit(ColumnName{"attitude_error_y_deg"}, row.attitude_error_y_deg);
  visit(ColumnName{"attitude_error_z_deg"}, row.attitude_error_z_deg);
  visit(ColumnName{"rate_error_radps"}, row.rate_error_radps);
  visit(ColumnName{"nees"}, row.nees);
  visit(ColumnName{"attitude_nees"}, row.attitude_nees);
}

template <columns::RowOf<KeypointRow> Row, class Visitor>
void visit_columns(Row& row, Visitor& visit) {
  visit(ColumnName{"time_s"}, row.time_s);
  visit(ColumnName{"image"}, row.image);
  visit(ColumnName{"keypoint"}, row.keypoint);
  visit(ColumnName{"fate"}, row.fate);
  visit(ColumnName{"peak"}, row.peak);
  visit(ColumnName{"x_px"}, row.x_px);
  visit(ColumnName{"y_px"}, row.y_px);
  visit(ColumnName{"covariance_xx_px2"}, row.covariance_xx_px2);
  visit(ColumnName{"covariance_xy_px2"}, row.covariance_xy_px2);
  visit(ColumnName{"covariance_yy_px2"}, row.covariance_yy_px2);
  visit(ColumnName{"error_x_px"}, row.error_x_px);
  visit(ColumnName{"error_y_px"}, row.error_y_px);
}

/// The picture itself is a file of its own.
template <columns::RowOf<GalleryImage> Row, class Visitor>
void visit_columns(Row& row, Visitor& visit) {
  visit(ColumnName{"time_s"}, row.time_s);
  visit(ColumnName{"image"}, row.image);
  visit(ColumnName{"caption"}, row.caption);
}

template <columns::RowOf<ManeuverRow> Row, class Visitor>
void visit_columns(Row& row, Visitor& visit) {
  visit(ColumnName{"maneuver_id"}, row.maneuver_id);
  visit(ColumnName{"waypoint_index"}, row.waypoint_index);
  visit(ColumnName{"solver"}, row.solver);
  visit(ColumnName{"command_time_s"}, row.command_time_s);
  visit(ColumnName{"execution_time_s"}, row.execution_time_s);
  visit(ColumnName{"accepted"}, row.accepted);
  columns::group(visit, "commanded_dv_rtn", columns::kRtnMps, row.commanded_dv_rtn_mps);
  columns::group(visit, "executed_dv_rtn", columns::kRtnMps, row.executed_dv_rtn_mps);
}

template <columns::RowOf<NoteRow> Row, class Visitor>
void visit_columns(Row& row, Visitor& visit) {
  visit(ColumnName{"time_s"}, row.time_s);
  visit(ColumnName{"source"}, row.source);
  visit(ColumnName{"name"}, row.name);
  visit(ColumnName{"value"}, row.value);
  visit(ColumnName{"text"}, row.text);
}

template <columns::RowOf<ResidualRow> Row, class Visitor>
void visit_columns(Row& row, Visitor& visit) {
  visit(ColumnName{"time_s"}, row.time_s);
  visit(ColumnName{"sensor"}, row.sensor);
  visit(ColumnName{"prefit"}, row.prefit);
  visit(ColumnName{"postfit"}, row.postfit);
  visit(ColumnName{"sigma"}, row.sigma);
}

template <columns::RowOf<WaypointRow> Row, class Visitor>
void visit_columns(Row& row, Visitor& visit) {
  visit(ColumnName{"index"}, row.index);
  visit(ColumnName{"time_s"}, row.time_s);
  columns::group(visit, "a_roe_desired", columns::kRoeM, row.a_roe_desired_m);
  columns::group(visit, "a_roe_actual", columns::kRoeM, row.a_roe_actual_m);
  columns::group(visit, "desired_position_rtn", columns::kRtnM, row.desired_position_rtn);
  columns::group(visit, "actual_position_rtn", columns::kRtnM, row.actual_position_rtn);
  visit(ColumnName{"control_error_m"}, row.control_error_m);
  visit(ColumnName{"navigation_error_m"}, row.navigation_error_m);
  visit(ColumnName{"navigation_velocity_error_mps"}, row.navigation_velocity_error_mps);
  visit(ColumnName{"leg_dv_mps"}, row.leg_dv_mps);
  visit(ColumnName{"cumulative_dv_mps"}, row.cumulative_dv_mps);
  visit(ColumnName{"leg_maneuvers"}, row.leg_maneuvers);
}

}  // namespace vbar::report
