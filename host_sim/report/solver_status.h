#pragma once
// The statuses of the control solvers in telemetry: the fields of telemetry_control that are named as a code of
// waypoint.kSolver and "_status" (fsw/packets/vbar.lcm).

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <type_traits>

#include <vbar/fields.h>

namespace vbar::report {

/// Returns the solver whose status a field of telemetry_control is; waypoint.kSolverNone for another field.
constexpr int solver_of_status(std::string_view field) {
  constexpr std::string_view kSuffix = "_status";
  if (!field.ends_with(kSuffix)) return waypoint::kSolverNone;
  field.remove_suffix(kSuffix.size());
  for (const Code& code : codes::waypoint_kSolver)
    if (field == code.word) return code.value;
  return waypoint::kSolverNone;
}

/// Calls visit(solver, name of the field, status) for each solver, in the order of telemetry_control.
template <class Visitor>
constexpr void visit_solver_statuses(const telemetry_control& message, Visitor&& visit) {
  visit_fields(message, [&](const Field& field, const auto& value) {
    if constexpr (std::is_same_v<std::remove_cvref_t<decltype(value)>, std::int8_t>) {
      const int solver = solver_of_status(field.name);
      if (solver != waypoint::kSolverNone) visit(solver, std::string_view(field.name), value);
    }
  });
}

inline constexpr std::size_t kSolverStatuses = [] {
  std::size_t count = 0;
  visit_solver_statuses(telemetry_control{},
                        [&](int /*solver*/, std::string_view /*name*/, int /*status*/) { ++count; });
  return count;
}();

/// A status of each solver, in the order of telemetry_control.
using SolverStatuses = std::array<int, kSolverStatuses>;

struct SolverStatusField {
  int solver = waypoint::kSolverNone;
  std::string_view name;
};
inline constexpr std::array<SolverStatusField, kSolverStatuses> kSolverStatusFields = [] {
  std::array<SolverStatusField, kSolverStatuses> fields{};
  std::size_t count = 0;
  visit_solver_statuses(telemetry_control{}, [&](int solver, std::string_view name, int /*status*/) {
    fields[count++] = {solver, name};
  });
  return fields;
}();

constexpr SolverStatuses solver_statuses(const telemetry_control& message) {
  SolverStatuses statuses{};
  std::size_t count = 0;
  visit_solver_statuses(message,
                        [&](int /*solver*/, std::string_view /*name*/, int status) { statuses[count++] = status; });
  return statuses;
}

/// Returns the place of a solver among the statuses; kSolverStatuses for a solver without one.
constexpr std::size_t place_of_status(int solver) {
  std::size_t place = 0;
  while (place < kSolverStatuses && kSolverStatusFields[place].solver != solver) ++place;
  return place;
}

}  // namespace vbar::report
