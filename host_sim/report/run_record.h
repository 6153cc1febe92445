#pragma once
// Record of a run as rows: filled while the mission flies, written to the run folder, read back for the
// report. SI units; frames in the names; ROE are mean, times the reference semi-major axis. A row about a message of
// telemetry is that message (fsw/packets/vbar.lcm) with the truth beside it.

#include <any>
#include <array>
#include <cmath>
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
#include "host_sim/report/solver_status.h"
#include "host_sim/report/summary.h"

namespace vbar::report {

using Pair = std::array<double, 2>;
using Triple = std::array<double, 3>;
using Sextuple = std::array<double, 6>;
using Quadruple = std::array<double, 4>;
/// A symmetric 6x6 matrix: lower triangle by rows.
using LowerTriangle6 = std::array<double, 21>;

/// Length of a vector; NaN if a component is NaN. Not std::hypot of three, in which GCC 12 loses a NaN between zeros.
[[nodiscard]] inline double magnitude(const Triple& v) {
  return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

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
  Triple rate_body_radps{};                  ///< angular rate of the body with respect to ECI, in body axes
};

/// Report of the flight software on itself at a step (estimate.csv).
struct EstimateRow {
  double time_s = 0.0;
  std::int64_t step = 0;
  int navigation_source = 0, navigation_valid = 0;
  Triple relative_position_rtn{}, relative_velocity_rtn{};
  Sextuple sigma_rtn{};
  Sextuple a_roe_mean_m{}, a_roe_desired_m{}, predicted_a_roe_error_m{};
  int mode = 0, active_solver = -1, waypoint_index = -1, planned_burns = 0;
  SolverStatuses solver_status{};
  int safety_status = 0;
  double planned_dv_mps = 0.0, passive_safety_distance_m = 0.0, commanded_dv_mps = 0.0;
  std::uint64_t step_cost = 0;  ///< instructions or cycles, 0 where the target cannot count them
  std::uint32_t stack_bytes = 0;
};

/// An image of the report's gallery (gallery.csv and gallery/<image>.png), and which pixels of the detector it shows.
/// All sizes are zero in folders whose pictures have their marks in the pixels.
struct GalleryImage {
  double time_s = 0.0;
  std::int32_t image = 0;
  std::string caption;
  int origin_x_px = 0, origin_y_px = 0, width_px = 0, height_px = 0;  ///< at the picture's upper left corner, 1:1
  double target_radius_px = 0.0;                                      ///< radius of a circle about the target
  int crop_left = 0, crop_side = 0;  ///< in the picture: where the crop of the pose network is; side 0: no crop
  std::vector<std::uint8_t> png;     ///< the file's bytes
  /// For an image of a testbed: the image that the digital twin makes of the same exposure (gallery/<image>_twin.png),
  /// the testbed's image less that one (gallery/<image>_difference.png), and how they differ; empty of other images.
  std::string difference = {};
  std::vector<std::uint8_t> twin_png = {}, difference_png = {};
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
  double time_s = 0.0;       ///< time of the packet, since the mission's epoch
  double step_time_s = 0.0;  ///< time of the step that it came with
  Message message{};
};

template <class Message>
using TelemetryTable = std::conditional_t<fsw::packets::is_telemetry(fsw::packets::MessageTraits<Message>::kApid),
                                          std::tuple<std::vector<TelemetryRow<Message>>>, std::tuple<>>;

/// A table of every message of telemetry: one that is new in vbar.lcm is here without a line. Those of which a module
/// makes rows beside the truth (Extension::messages) stay empty.
#define VBAR_MESSAGE(type, enumerator, number, route) , std::declval<TelemetryTable<type>>()
using TelemetryTables = decltype(std::tuple_cat(std::tuple<>() VBAR_FOR_EACH_MESSAGE(VBAR_MESSAGE)));
#undef VBAR_MESSAGE

/// Note of a source or an actuator on a measurement or a burn, or the reason of its failure (notes.csv).
struct NoteRow {
  double time_s = 0.0;  ///< since the mission's epoch
  std::string source;   ///< "servicer/gnss"
  std::string name;     ///< with the unit; "failure": `text` is the reason
  std::optional<double> value;
  std::string text;
};

/// A fault of the scenario, and its effects as observers other than its cause have seen them (faults.csv). Times since
/// the mission's epoch.
struct FaultRow {
  std::string name, kind, unit;
  std::string event;               ///< with which it begins; empty: at a time
  std::optional<double> begin_s;   ///< empty: its event never happened
  std::optional<double> end_s;     ///< empty: it lasts to the end, or never began
  std::optional<double> effect_s;  ///< first observed; empty: it never took effect
  /// Time at which the disturbed quantity and the aid of navigation by it are as before; empty: not seen.
  std::optional<double> recovered_s;
  int witnessed = 0;  ///< times
  std::string evidence;
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
/// Additions of modules outside this library to record, summary and report (extension.h).
using Extensions = std::span<const Extension* const>;

struct RunRecord {
  Summary summary;
  std::vector<WaypointRow> waypoints;
  std::vector<TruthRow> truth;
  std::vector<AttitudeRow> attitudes;
  std::vector<EstimateRow> estimates;
  std::vector<GalleryImage> gallery;
  std::vector<ManeuverRow> maneuvers;
  std::vector<ResidualRow> residuals;
  std::vector<NoteRow> notes;
  std::vector<FaultRow> faults;
  TelemetryTables telemetry;
  Extensions extensions;
  TableSet tables;                         ///< tables of the extensions
  std::vector<std::string> reading_notes;  ///< what reading the folder had to leave out

  template <class Message>
  [[nodiscard]] const std::vector<TelemetryRow<Message>>& of() const {
    return std::get<std::vector<TelemetryRow<Message>>>(telemetry);
  }
};

}  // namespace vbar::report
