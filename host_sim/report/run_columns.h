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

/// The parts of a column's name, joined by underscores.
struct ColumnName {
  std::string_view stem, element{}, unit{};
  int number = -1;  ///< of an element without a name

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
void group(Visitor& visit, std::string_view name, const std::array<std::string_view, size>& elements,
           std::string_view unit, Values& values) {
  static_assert(std::tuple_size_v<std::remove_const_t<Values>> == size);
  for (std::size_t k = 0; k < size; ++k) visit(ColumnName{name, elements[k], unit}, values[k]);
}

template <std::size_t size>
constexpr Codes words(const Code (&codes)[size]) {
  return {codes, size, false};
}

template <class Visitor, class Number>
void coded(Visitor& visit, std::string_view name, Codes codes, Number& value) {
  visit(ColumnName{name}, Coded<Number>{value, codes});
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
        cell(ColumnName{field.stem, named ? field.elements[k] : "", field.unit, named ? -1 : k}, value[k]);
      }
    } else {
      cell(ColumnName{field.stem, {}, field.unit}, value);
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
  visit(ColumnName{"time_s"}, row.time_s);
  visit(ColumnName{"step_time_s"}, row.step_time_s);
  columns::fields(visit, row.message);
}

template <columns::RowOf<TruthRow> Row, class Visitor>
void visit_columns(Row& row, Visitor& visit) {
  using namespace columns;
  visit(ColumnName{"time_s"}, row.time_s);
  group(visit, "servicer_position_eci", kXyz, "m", row.servicer_position_eci);
  group(visit, "servicer_velocity_eci", kXyz, "mps", row.servicer_velocity_eci);
  group(visit, "target_position_eci", kXyz, "m", row.target_position_eci);
  group(visit, "target_velocity_eci", kXyz, "mps", row.target_velocity_eci);
  group(visit, "relative_position_rtn", kRtn, "m", row.relative_position_rtn);
  group(visit, "relative_velocity_rtn", kRtn, "mps", row.relative_velocity_rtn);
  group(visit, "a_roe_mean", kRoe, "m", row.a_roe_mean_m);
}

template <columns::RowOf<AttitudeRow> Row, class Visitor>
void visit_columns(Row& row, Visitor& visit) {
  visit(ColumnName{"time_s"}, row.time_s);
  visit(ColumnName{"spacecraft"}, row.spacecraft);
  columns::group(visit, "q_body_eci", columns::kWxyz, "", row.q_body_eci);
  columns::group(visit, "rate_body", columns::kXyz, "radps", row.rate_body_radps);
}

template <columns::RowOf<EstimateRow> Row, class Visitor>
void visit_columns(Row& row, Visitor& visit) {
  using namespace columns;
  visit(ColumnName{"time_s"}, row.time_s);
  visit(ColumnName{"step"}, row.step);
  coded(visit, "navigation_source", words(codes::telemetry_navigation_kSource), row.navigation_source);
  visit(ColumnName{"navigation_valid"}, row.navigation_valid);
  group(visit, "relative_position_rtn", kRtn, "m", row.relative_position_rtn);
  group(visit, "relative_velocity_rtn", kRtn, "mps", row.relative_velocity_rtn);
  group(visit, "sigma_rtn", kRtnMAndMps, "", row.sigma_rtn);
  group(visit, "a_roe_mean", kRoe, "m", row.a_roe_mean_m);
  group(visit, "a_roe_desired", kRoe, "m", row.a_roe_desired_m);
  group(visit, "predicted_a_roe_error", kRoe, "m", row.predicted_a_roe_error_m);
  coded(visit, "mode", words(codes::mode_command_kMode), row.mode);
  coded(visit, "active_solver", words(codes::waypoint_kSolver), row.active_solver);
  visit(ColumnName{"waypoint_index"}, row.waypoint_index);
  visit(ColumnName{"planned_burns"}, row.planned_burns);
  coded(visit, "koenig_damico_status", words(codes::telemetry_control_kStatus), row.koenig_damico_status);
  coded(visit, "closed_form_status", words(codes::telemetry_control_kStatus), row.closed_form_status);
  coded(visit, "least_squares_status", words(codes::telemetry_control_kStatus), row.least_squares_status);
  coded(visit, "safety_status", words(codes::telemetry_control_kStatus), row.safety_status);
  visit(ColumnName{"planned_dv_mps"}, row.planned_dv_mps);
  visit(ColumnName{"passive_safety_distance_m"}, row.passive_safety_distance_m);
  visit(ColumnName{"commanded_dv_mps"}, row.commanded_dv_mps);
  visit(ColumnName{"step_cost"}, row.step_cost);
  visit(ColumnName{"stack_bytes"}, row.stack_bytes);
}

/// The picture itself is a file of its own.
template <columns::RowOf<GalleryImage> Row, class Visitor>
void visit_columns(Row& row, Visitor& visit) {
  visit(ColumnName{"time_s"}, row.time_s);
  visit(ColumnName{"image"}, row.image);
  visit(ColumnName{"caption"}, row.caption);
  visit(ColumnName{"origin_x_px"}, row.origin_x_px);
  visit(ColumnName{"origin_y_px"}, row.origin_y_px);
  visit(ColumnName{"width_px"}, row.width_px);
  visit(ColumnName{"height_px"}, row.height_px);
  visit(ColumnName{"target_radius_px"}, row.target_radius_px);
  visit(ColumnName{"crop_left"}, row.crop_left);
  visit(ColumnName{"crop_side"}, row.crop_side);
  visit(ColumnName{"difference"}, row.difference);
}

template <columns::RowOf<ManeuverRow> Row, class Visitor>
void visit_columns(Row& row, Visitor& visit) {
  visit(ColumnName{"maneuver_id"}, row.maneuver_id);
  visit(ColumnName{"waypoint_index"}, row.waypoint_index);
  columns::coded(visit, "solver", columns::words(codes::waypoint_kSolver), row.solver);
  visit(ColumnName{"command_time_s"}, row.command_time_s);
  visit(ColumnName{"execution_time_s"}, row.execution_time_s);
  visit(ColumnName{"accepted"}, row.accepted);
  columns::group(visit, "commanded_dv_rtn", columns::kRtn, "mps", row.commanded_dv_rtn_mps);
  columns::group(visit, "executed_dv_rtn", columns::kRtn, "mps", row.executed_dv_rtn_mps);
}

template <columns::RowOf<NoteRow> Row, class Visitor>
void visit_columns(Row& row, Visitor& visit) {
  visit(ColumnName{"time_s"}, row.time_s);
  visit(ColumnName{"source"}, row.source);
  visit(ColumnName{"name"}, row.name);
  visit(ColumnName{"value"}, row.value);
  visit(ColumnName{"text"}, row.text);
}

template <columns::RowOf<FaultRow> Row, class Visitor>
void visit_columns(Row& row, Visitor& visit) {
  visit(ColumnName{"name"}, row.name);
  visit(ColumnName{"kind"}, row.kind);
  visit(ColumnName{"unit"}, row.unit);
  visit(ColumnName{"event"}, row.event);
  visit(ColumnName{"begin_s"}, row.begin_s);
  visit(ColumnName{"end_s"}, row.end_s);
  visit(ColumnName{"effect_s"}, row.effect_s);
  visit(ColumnName{"recovered_s"}, row.recovered_s);
  visit(ColumnName{"witnessed"}, row.witnessed);
  visit(ColumnName{"evidence"}, row.evidence);
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
  using namespace columns;
  visit(ColumnName{"index"}, row.index);
  visit(ColumnName{"time_s"}, row.time_s);
  group(visit, "a_roe_desired", kRoe, "m", row.a_roe_desired_m);
  group(visit, "a_roe_actual", kRoe, "m", row.a_roe_actual_m);
  group(visit, "desired_position_rtn", kRtn, "m", row.desired_position_rtn);
  group(visit, "actual_position_rtn", kRtn, "m", row.actual_position_rtn);
  visit(ColumnName{"control_error_m"}, row.control_error_m);
  visit(ColumnName{"navigation_error_m"}, row.navigation_error_m);
  visit(ColumnName{"navigation_velocity_error_mps"}, row.navigation_velocity_error_mps);
  visit(ColumnName{"leg_dv_mps"}, row.leg_dv_mps);
  visit(ColumnName{"cumulative_dv_mps"}, row.cumulative_dv_mps);
  visit(ColumnName{"leg_maneuvers"}, row.leg_maneuvers);
}

}  // namespace vbar::report
