#pragma once
// The columns of each table, once for writing and reading alike: visit_columns(row, visitor) calls
// visitor(ColumnName, value) in the order of the file. A message's columns come from vbar.lcm.

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <type_traits>

#include "host_sim/report/csv_table.h"
#include "host_sim/report/run_record.h"

namespace vbar::report {

/// The parts of a column's name, joined by underscores, and what the column means.
struct ColumnName {
  std::string_view stem, meaning, element{}, unit{};
  int number = -1;  ///< index of an element without a name

  [[nodiscard]] std::string text() const {
    std::string joined(stem);
    if (number >= 0) joined += "_" + std::to_string(number);
    for (const std::string_view part : {element, unit})
      if (!part.empty()) joined.append("_").append(part);
    return joined;
  }
};

namespace columns {

using Names3 = std::array<std::string_view, 3>;
inline constexpr Names3 kXyz{"x", "y", "z"}, kRtn{"r", "t", "n"};
inline constexpr std::array<std::string_view, 4> kWxyz{"w", "x", "y", "z"};
inline constexpr std::array<std::string_view, 6> kRtnMAndMps{"r_m", "t_m", "n_m", "r_mps", "t_mps", "n_mps"};
inline constexpr std::array<std::string_view, 6> kRoe{"da", "dlambda", "dex", "dey", "dix", "diy"};

template <class Visitor, class Values, std::size_t size>
void group(Visitor& visit, std::string_view name, std::string_view meaning,
           const std::array<std::string_view, size>& elements, std::string_view unit, Values& values) {
  static_assert(std::tuple_size_v<std::remove_const_t<Values>> == size);
  for (std::size_t k = 0; k < size; ++k) visit(ColumnName{name, meaning, elements[k], unit}, values[k]);
}

template <std::size_t size>
constexpr Codes words(const Code (&codes)[size]) {
  return {codes, size, false};
}

template <class Visitor, class Number>
void coded(Visitor& visit, std::string_view name, std::string_view meaning, Codes codes, Number& value) {
  visit(ColumnName{name, meaning}, Coded<Number>{value, codes});
}

/// All fields of a message; of one whose unnamed elements are rows of another table, those that are not.
template <class Visitor, class Message>
void fields(Visitor& visit, Message& message, bool numbered_elements = true) {
  visit_fields(message, [&](const Field& field, auto& value) {
    using Value = std::remove_reference_t<decltype(value)>;
    const auto cell = [&](const ColumnName& name, auto& number) {
      if constexpr (std::is_integral_v<std::remove_reference_t<decltype(number)>>) {
        if (field.codes.count > 0)
          return visit(name, Coded<std::remove_reference_t<decltype(number)>>{number, field.codes});
      }
      visit(name, number);
    };
    if constexpr (std::is_array_v<Value>) {
      if (field.elements == nullptr && !numbered_elements) return;
      for (int k = 0; k < static_cast<int>(std::extent_v<Value>); ++k) {
        const bool named = field.elements != nullptr;
        cell(ColumnName{field.stem, field.meaning, named ? field.elements[k] : "", field.unit, named ? -1 : k},
             value[k]);
      }
    } else {
      cell(ColumnName{field.stem, field.meaning, {}, field.unit}, value);
    }
  });
}

/// `Row`, as a row that is written (const) or one that is read.
template <class Some, class Row>
concept RowOf = std::is_same_v<std::remove_const_t<Some>, Row>;

/// The message that a row is.
template <class Message, class Row>
auto& message_of(Row& row) {
  return static_cast<std::conditional_t<std::is_const_v<Row>, const Message, Message>&>(row);
}

}  // namespace columns

template <class Row, class Visitor>
requires requires(Row row) {
  row.message;
}
void visit_columns(Row& row, Visitor& visit) {
  visit(ColumnName{"time_s", "s, since the epoch of the mission, of the packet"}, row.time_s);
  visit(ColumnName{"step_time_s", "s, since the epoch of the mission: of the step that it came with"}, row.step_time_s);
  columns::fields(visit, row.message);
}

template <columns::RowOf<TruthRow> Row, class Visitor>
void visit_columns(Row& row, Visitor& visit) {
  using namespace columns;
  visit(ColumnName{"time_s", "s, since the epoch of the mission"}, row.time_s);
  group(visit, "servicer_position_eci", "GCRF", kXyz, "m", row.servicer_position_eci);
  group(visit, "servicer_velocity_eci", "GCRF", kXyz, "mps", row.servicer_velocity_eci);
  group(visit, "target_position_eci", "GCRF", kXyz, "m", row.target_position_eci);
  group(visit, "target_velocity_eci", "GCRF", kXyz, "mps", row.target_velocity_eci);
  group(visit, "relative_position_rtn", "of the target, in the servicer's RTN frame", kRtn, "m",
        row.relative_position_rtn);
  group(visit, "relative_velocity_rtn", "of the target, in the servicer's RTN frame", kRtn, "mps",
        row.relative_velocity_rtn);
  group(visit, "a_roe_mean", "mean relative orbital elements times the reference semi-major axis", kRoe, "m",
        row.a_roe_mean_m);
}

template <columns::RowOf<AttitudeRow> Row, class Visitor>
void visit_columns(Row& row, Visitor& visit) {
  visit(ColumnName{"time_s", "s, since the epoch of the mission"}, row.time_s);
  visit(ColumnName{"spacecraft", "its name"}, row.spacecraft);
  columns::group(visit, "q_body_eci", "unit quaternion, turns ECI components into body components", columns::kWxyz, "",
                 row.q_body_eci);
  columns::group(visit, "rate_body", "of the body with respect to ECI, in body axes", columns::kXyz, "radps",
                 row.rate_body_radps);
}

template <columns::RowOf<EstimateRow> Row, class Visitor>
void visit_columns(Row& row, Visitor& visit) {
  using namespace columns;
  visit(ColumnName{"time_s", "s, since the epoch of the mission"}, row.time_s);
  visit(ColumnName{"step", "number of the step"}, row.step);
  coded(visit, "navigation_source", "most accurate source of the estimate", words(codes::telemetry_navigation_kSource),
        row.navigation_source);
  visit(ColumnName{"navigation_valid", "1: the estimate is valid"}, row.navigation_valid);
  group(visit, "relative_position_rtn", "estimate of the target, in the servicer's RTN frame", kRtn, "m",
        row.relative_position_rtn);
  group(visit, "relative_velocity_rtn", "estimate of the target, in the servicer's RTN frame", kRtn, "mps",
        row.relative_velocity_rtn);
  group(visit, "sigma_rtn", "1 sigma of the estimate", kRtnMAndMps, "", row.sigma_rtn);
  group(visit, "a_roe_mean", "estimated mean relative orbital elements times the reference semi-major axis", kRoe, "m",
        row.a_roe_mean_m);
  group(visit, "a_roe_desired", "desired at the next waypoint", kRoe, "m", row.a_roe_desired_m);
  group(visit, "predicted_a_roe_error", "at the waypoint, the rest of the plan included", kRoe, "m",
        row.predicted_a_roe_error_m);
  coded(visit, "mode", "of guidance", words(codes::mode_command_kMode), row.mode);
  coded(visit, "active_solver", "solver of the plan being flown", words(codes::waypoint_kSolver), row.active_solver);
  visit(ColumnName{"waypoint_index", "next waypoint, -1 none"}, row.waypoint_index);
  visit(ColumnName{"planned_burns", "left in the plan"}, row.planned_burns);
  for (std::size_t k = 0; k < kSolverStatuses; ++k)
    coded(visit, kSolverStatusFields[k].name, "of the last attempt of this solver",
          words(codes::telemetry_control_kStatus), row.solver_status[k]);
  coded(visit, "safety_status", "of the last assessment of a plan", words(codes::telemetry_control_kStatus),
        row.safety_status);
  visit(ColumnName{"planned_dv_mps", "of the burns left in the plan"}, row.planned_dv_mps);
  visit(ColumnName{"passive_safety_distance_m", "minimum over the horizon and all partial burn sequences of the plan"},
        row.passive_safety_distance_m);
  visit(ColumnName{"commanded_dv_mps", "since the start"}, row.commanded_dv_mps);
  visit(ColumnName{"step_cost",
                   "of the step: instructions or processor cycles, 0 where the flight computer does not count them"},
        row.step_cost);
  visit(ColumnName{"stack_bytes", "high-water mark of the flight software, 0 unknown"}, row.stack_bytes);
}

/// The picture itself is a file of its own.
template <columns::RowOf<GalleryImage> Row, class Visitor>
void visit_columns(Row& row, Visitor& visit) {
  visit(ColumnName{"time_s", "s, since the epoch of the mission"}, row.time_s);
  visit(ColumnName{"image", "number of the exposure"}, row.image);
  visit(ColumnName{"caption", "text under the picture"}, row.caption);
  visit(ColumnName{"origin_x_px", "place of the picture's upper left corner on the detector"}, row.origin_x_px);
  visit(ColumnName{"origin_y_px", "place of the picture's upper left corner on the detector"}, row.origin_y_px);
  visit(ColumnName{"width_px", "of the picture"}, row.width_px);
  visit(ColumnName{"height_px", "of the picture"}, row.height_px);
  visit(ColumnName{"target_radius_px", "of a circle about the target"}, row.target_radius_px);
  visit(ColumnName{"crop_left", "left edge of the pose network's crop in the picture"}, row.crop_left);
  visit(ColumnName{"crop_side", "side of that crop, 0 without"}, row.crop_side);
  visit(ColumnName{"difference", "how the testbed's image differs from the digital twin's"}, row.difference);
}

template <columns::RowOf<ManeuverRow> Row, class Visitor>
void visit_columns(Row& row, Visitor& visit) {
  visit(ColumnName{"maneuver_id", "number of the command"}, row.maneuver_id);
  visit(ColumnName{"waypoint_index", "waypoint that the maneuver leads to"}, row.waypoint_index);
  columns::coded(visit, "solver", "that planned it", columns::words(codes::waypoint_kSolver), row.solver);
  visit(ColumnName{"command_time_s", "s, since the epoch of the mission: when it was commanded"}, row.command_time_s);
  visit(ColumnName{"execution_time_s", "s, since the epoch of the mission: when it was to be executed"},
        row.execution_time_s);
  visit(ColumnName{"accepted", "1: the thruster accepted the command"}, row.accepted);
  columns::group(visit, "commanded_dv_rtn", "in the RTN frame at its execution", columns::kRtn, "mps",
                 row.commanded_dv_rtn_mps);
  columns::group(visit, "executed_dv_rtn", "that the truth model applied", columns::kRtn, "mps",
                 row.executed_dv_rtn_mps);
}

template <columns::RowOf<NoteRow> Row, class Visitor>
void visit_columns(Row& row, Visitor& visit) {
  visit(ColumnName{"time_s", "s, since the epoch of the mission"}, row.time_s);
  visit(ColumnName{"source", "a source or an actuator, as servicer/gnss"}, row.source);
  visit(ColumnName{"name", "of the quantity, with its unit; failure: the text is the reason"}, row.name);
  visit(ColumnName{"value", "of the quantity"}, row.value);
  visit(ColumnName{"text", "reason of a failure"}, row.text);
}

template <columns::RowOf<FaultRow> Row, class Visitor>
void visit_columns(Row& row, Visitor& visit) {
  visit(ColumnName{"name", "of the fault in the mission"}, row.name);
  visit(ColumnName{"kind", "of fault"}, row.kind);
  visit(ColumnName{"unit", "that it acts on"}, row.unit);
  visit(ColumnName{"event", "with which it begins; empty: at a time"}, row.event);
  visit(ColumnName{"begin_s", "s, since the epoch of the mission; empty: its event never happened"}, row.begin_s);
  visit(ColumnName{"end_s", "s, since the epoch of the mission; empty: it lasts to the end or never began"}, row.end_s);
  visit(ColumnName{"effect_s",
                   "s, since the epoch of the mission: its effect was first witnessed; empty: it never took effect"},
        row.effect_s);
  visit(ColumnName{"recovered_s", "s, since the epoch of the mission: what it disturbed is as before; empty: not seen"},
        row.recovered_s);
  visit(ColumnName{"witnessed", "number of witnessed effects"}, row.witnessed);
  visit(ColumnName{"evidence", "what the witness saw"}, row.evidence);
}

template <columns::RowOf<ResidualRow> Row, class Visitor>
void visit_columns(Row& row, Visitor& visit) {
  visit(ColumnName{"time_s", "s, since the epoch of the mission"}, row.time_s);
  visit(ColumnName{"sensor", "measurement type; its name ends in the unit"}, row.sensor);
  visit(ColumnName{"prefit", "measured minus predicted"}, row.prefit);
  visit(ColumnName{"postfit", "measured minus estimated"}, row.postfit);
  visit(ColumnName{"sigma", "1 sigma of the innovation along the residual"}, row.sigma);
}

template <columns::RowOf<WaypointRow> Row, class Visitor>
void visit_columns(Row& row, Visitor& visit) {
  using namespace columns;
  visit(ColumnName{"index", "of the waypoint"}, row.index);
  visit(ColumnName{"time_s", "s, since the epoch of the mission"}, row.time_s);
  group(visit, "a_roe_desired",
        "mean relative orbital elements times the reference semi-major axis, as the mission states them", kRoe, "m",
        row.a_roe_desired_m);
  group(visit, "a_roe_actual", "the true ones", kRoe, "m", row.a_roe_actual_m);
  group(visit, "desired_position_rtn", "of the target, in the servicer's RTN frame", kRtn, "m",
        row.desired_position_rtn);
  group(visit, "actual_position_rtn", "of the target, in the servicer's RTN frame", kRtn, "m", row.actual_position_rtn);
  visit(ColumnName{"control_error_m", "distance between actual and desired position"}, row.control_error_m);
  visit(ColumnName{"navigation_error_m", "distance between estimated and actual position"}, row.navigation_error_m);
  visit(ColumnName{"navigation_velocity_error_mps", "estimated minus actual velocity"},
        row.navigation_velocity_error_mps);
  visit(ColumnName{"leg_dv_mps", "of the burns since the waypoint before"}, row.leg_dv_mps);
  visit(ColumnName{"cumulative_dv_mps", "of all burns"}, row.cumulative_dv_mps);
  visit(ColumnName{"leg_maneuvers", "burns since the waypoint before"}, row.leg_maneuvers);
}

}  // namespace vbar::report
