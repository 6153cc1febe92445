#include "host_sim/report/code_names.h"

#include <algorithm>

#include <vbar/fields.h>

#include "host_sim/report/csv_table.h"

namespace vbar::report {
namespace {

template <std::size_t size>
std::string name_in(const Code (&codes)[size], int value) {
  const bool known = std::ranges::any_of(codes, [value](const Code& code) { return code.value == value; });
  if (!known) return fmt::format("unknown ({})", value);
  std::string name = word_of({codes, size, false}, value);
  std::ranges::replace(name, '_', ' ');
  return name;
}

}  // namespace

std::string mode_name(int mode) {
  return name_in(codes::mode_command_kMode, mode);
}
std::string solver_name(int solver) {
  return solver == waypoint::kSolverKoenigDamico ? "Koenig-D'Amico" : name_in(codes::waypoint_kSolver, solver);
}
std::vector<int> solvers() {
  std::vector<int> all;
  for (const Code& code : codes::waypoint_kSolver)
    if (code.value != waypoint::kSolverNone) all.push_back(code.value);
  return all;
}
std::string status_name(int status) {
  return name_in(codes::telemetry_control_kStatus, status);
}
std::string sighting_name(int status) {
  return name_in(codes::telemetry_image_kStatus, status);
}
std::string pose_sighting_name(int status) {
  return name_in(codes::telemetry_pose_kStatus, status);
}

}  // namespace vbar::report
