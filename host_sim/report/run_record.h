#pragma once
// What a run leaves behind, as rows: filled while the mission flies, written to the run folder, read back for the
// report. SI units; frames in the names; ROE are mean, times the reference semi-major axis. A row about a message of
// telemetry is that message (fsw/packets/vbar.lcm) with the truth beside it.

#include <any>
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <type_traits>
#include <typeindex>
#include <utility>
#include <vector>

#include "fsw/packets/message_traits.h"
#include "host_sim/report/summary.h"

namespace vbar::report {

using Pair = std::array<double, 2>;
using Triple = std::array<double, 3>;
using Sextuple = std::array<double, 6>;
using Quadruple = std::array<double, 4>;
/// A symmetric 6x6 matrix: lower triangle by rows.
using LowerTriangle6 = std::array<double, 21>;

/// Truth at a step (truth.csv).
struct TruthRow {
  double time_s = 0.0;  ///< since the mission's epoch
  Triple servicer_position_eci{}, servicer_velocity_eci{};
  Triple target_position_eci{}, target_velocity_eci{};
  Triple relative_position_rtn{}, relative_velocity_rtn{};  ///< target in the servicer's RTN
  Sextuple a_roe_mean_m{};
};

/// True attitude of one spacecraft at a step (attitude.csv, only if the mission has attitudes).
struct AttitudeRow {
  double time_s = 0.0;
  std::string spacecraft;
  Quadruple q_body_eci{1.0, 0.0, 0.0, 0.0};  ///< w, x, y, z: turns ECI components into body components
  Triple rate_body_radps{};                  ///< of the body with respect to ECI, in body axes
};

/// What the flight software said of itself at a step (estimate.csv).
struct EstimateRow {
  double time_s = 0.0;
  std::int64_t step = 0;
  int navigation_source = 0, navigation_valid = 0;
  Triple relative_position_rtn{}, relative_velocity_rtn{};
  Sextuple sigma_rtn{};
  Sextuple a_roe_mean_m{}, a_roe_desired_m{}, predicted_a_roe_error_m{};
  int mode = 0, active_solver = -1, waypoint_index = -1, planned_burns = 0;
  int koenig_damico_status = 0, closed_form_status = 0, least_squares_status = 0, safety_status = 0;
  double planned_dv_mps = 0.0, passive_safety_distance_m = 0.0, commanded_dv_mps = 0.0;
  std::uint64_t step_cost = 0;  ///< instructions or cycles, 0 where the target cannot count them
  std::uint32_t stack_bytes = 0;
};

/// What navigation by GNSS said of itself at a step (gnss.csv, only if a run has such navigation).
struct GnssRow : telemetry_gnss {
  GnssRow() : telemetry_gnss{} {}
  double time_s = 0.0;
  std::optional<double> epoch_s;  ///< of the last measurements used, as time_s
};

/// What angles-only navigation said of an image, and what was true at its exposure (images.csv, only if a run has such
/// navigation).
struct ImageRow : telemetry_image {
  ImageRow() : telemetry_image{} {}
  double time_s = 0.0;       ///< middle of the exposure, since the mission's epoch
  double step_time_s = 0.0;  ///< of the step whose telemetry reported it
  // The truth. Errors are estimated less true; absent where the flight software gave nothing.
  int true_object = -1;  ///< the object that is really the target; -1: none is, or nobody can tell
  std::string chosen;    ///< the spacecraft that the choice really is, "nothing" if none; empty without a choice
  std::optional<double> range_m;
  std::optional<double> bearing_error_x_arcsec, bearing_error_y_arcsec;            ///< against the centre of mass
  std::optional<double> attitude_error_across_arcsec, attitude_error_roll_arcsec;  ///< of the boresight, and about it
  std::optional<double> nees;  ///< of the osculating ROE, six degrees of freedom; of images that the filter used
};

/// What the flight software took an object of an image for (objects.csv).
struct ObjectRow {
  double time_s = 0.0;
  std::int32_t image = 0;
  int object = 0;  ///< brightest first
  int kind = 0;    ///< telemetry_objects::kKind...
  std::int32_t star = 0;
  float x_px = 0.0F, y_px = 0.0F;  ///< on the detector
};

/// What navigation by the pose network said of an image, and what was true at its exposure (poses.csv, only if a run
/// has such navigation). The keypoints are rows of their own.
struct PoseRow : telemetry_pose {
  PoseRow() : telemetry_pose{} {}
  double time_s = 0.0;       ///< middle of the exposure, since the mission's epoch
  double step_time_s = 0.0;  ///< of the step whose telemetry reported it
  // The truth. Errors are estimated less true; absent where the flight software gave nothing.
  std::optional<double> range_m, sunlit;
  std::optional<double> pnp_error_x_m, pnp_error_y_m, pnp_error_z_m, pnp_error_deg;        ///< in camera axes
  std::optional<double> attitude_error_deg;                                                ///< in all
  std::optional<double> attitude_error_x_deg, attitude_error_y_deg, attitude_error_z_deg;  ///< about body axes
  std::optional<double> rate_error_radps;
  std::optional<double> nees, attitude_nees;  ///< of osculating ROE, of turn and rate: six degrees of freedom each
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

/// An image of the report's gallery (gallery.csv and gallery/<image>.png), and which pixels of the detector it shows.
/// All sizes are zero in folders whose pictures have their marks in the pixels.
struct GalleryImage {
  double time_s = 0.0;
  std::int32_t image = 0;
  std::string caption;
  int origin_x_px = 0, origin_y_px = 0, width_px = 0, height_px = 0;  ///< at the picture's upper left corner, 1:1
  double target_radius_px = 0.0;                                      ///< of a circle about the target
  int crop_left = 0, crop_side = 0;  ///< in the picture: where the crop of the pose network is; side 0: no crop
  std::vector<std::uint8_t> png;     ///< the file's bytes
};

/// A maneuver from command to execution (maneuvers.csv).
struct ManeuverRow {
  int maneuver_id = 0, waypoint_index = -1, solver = -1;
  double command_time_s = 0.0, execution_time_s = 0.0;
  bool accepted = false;
  Triple commanded_dv_rtn_mps{}, executed_dv_rtn_mps{};
};

/// A residual of navigation (residuals.csv, only if there are any), in the unit that the sensor's name ends in. Sigma
/// is that of the innovation along the residual vector, |prefit| / sqrt(NIS).
struct ResidualRow {
  double time_s = 0.0;
  std::string sensor;
  double prefit = 0.0, postfit = 0.0, sigma = 0.0;
};

/// A waypoint of the table and how it was met (waypoints.csv).
struct WaypointRow {
  int index = 0;
  double time_s = 0.0;
  Sextuple a_roe_desired_m{}, a_roe_actual_m{};
  Triple desired_position_rtn{}, actual_position_rtn{};
  double control_error_m = 0.0;
  std::optional<double> navigation_error_m, navigation_velocity_error_mps;
  double leg_dv_mps = 0.0, cumulative_dv_mps = 0.0;
  int leg_maneuvers = 0;
};

/// A message of telemetry as it came (<message>.csv).
template <class Message>
struct TelemetryRow {
  double time_s = 0.0;       ///< of the packet, since the mission's epoch
  double step_time_s = 0.0;  ///< of the step that it came with
  Message message{};
};

/// True for messages whose every field is in a table that has the truth beside it.
template <class Message>
inline constexpr bool kHasTableWithTruth = false;
template <>
inline constexpr bool kHasTableWithTruth<telemetry_gnss> = true;
template <>
inline constexpr bool kHasTableWithTruth<telemetry_image> = true;
template <>
inline constexpr bool kHasTableWithTruth<telemetry_objects> = true;
template <>
inline constexpr bool kHasTableWithTruth<telemetry_pose> = true;

template <class Message>
using TelemetryTable = std::conditional_t<fsw::packets::is_telemetry(fsw::packets::MessageTraits<Message>::kApid) &&
                                              !kHasTableWithTruth<Message>,
                                          std::tuple<std::vector<TelemetryRow<Message>>>, std::tuple<>>;

/// A table of every other message of telemetry: one that is new in vbar.lcm is here without a line.
#define VBAR_MESSAGE(type, enumerator) , std::declval<TelemetryTable<type>>()
using TelemetryTables = decltype(std::tuple_cat(std::tuple<>() VBAR_FOR_EACH_MESSAGE(VBAR_MESSAGE)));
#undef VBAR_MESSAGE

/// What a source or an actuator reported of a measurement or a burn, or why it failed (notes.csv).
struct NoteRow {
  double time_s = 0.0;  ///< since the mission's epoch
  std::string source;   ///< "servicer/gnss"
  std::string name;     ///< with the unit; "failure": `text` is the reason
  std::optional<double> value;
  std::string text;
};

/// The row that a message is, with nothing beside it yet.
template <class Row, class Message>
Row row_of(const Message& message) {
  Row row;
  static_cast<Message&>(row) = message;
  return row;
}

/// Rows of any types: tables that this library does not know.
class TableSet {
 public:
  template <class Row>
  [[nodiscard]] std::vector<Row>& rows() {
    std::any& rows = tables_[typeid(Row)];
    if (!rows.has_value()) rows = std::vector<Row>();
    return std::any_cast<std::vector<Row>&>(rows);
  }
  template <class Row>
  [[nodiscard]] const std::vector<Row>& rows() const {
    static const std::vector<Row> kNone;
    const auto found = tables_.find(typeid(Row));
    return found == tables_.end() ? kNone : std::any_cast<const std::vector<Row>&>(found->second);
  }

 private:
  std::map<std::type_index, std::any> tables_;
};

struct Extension;
/// What modules outside this library add to record, summary and report (extension.h).
using Extensions = std::span<const Extension* const>;

struct RunRecord {
  Summary summary;
  std::vector<WaypointRow> waypoints;
  std::vector<TruthRow> truth;
  std::vector<AttitudeRow> attitudes;
  std::vector<EstimateRow> estimates;
  std::vector<GnssRow> gnss;
  std::vector<ImageRow> images;
  std::vector<ObjectRow> objects;
  std::vector<PoseRow> poses;
  std::vector<KeypointRow> keypoints;
  std::vector<GalleryImage> gallery;
  std::vector<ManeuverRow> maneuvers;
  std::vector<ResidualRow> residuals;
  std::vector<NoteRow> notes;
  TelemetryTables telemetry;
  Extensions extensions;
  TableSet tables;                         ///< of the extensions
  std::vector<std::string> reading_notes;  ///< what reading the folder had to leave out

  template <class Message>
  [[nodiscard]] const std::vector<TelemetryRow<Message>>& of() const {
    return std::get<std::vector<TelemetryRow<Message>>>(telemetry);
  }
};

}  // namespace vbar::report
