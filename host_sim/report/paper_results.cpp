#include "host_sim/report/paper_results.h"

#include <fmt/format.h>

#include "host_sim/report/published_figures.h"

namespace vbar::report {

namespace {

using Cells = std::map<std::string, double>;

void add(Cells& cells, const std::string& place, const paper1::Loop& figures) {
  cells[place + ".navigation_error_m"] = figures.navigation_error_m;
  cells[place + ".control_error_m"] = figures.control_error_m;
}

void add(Cells& cells, const std::string& place, const paper3::Figures& figures) {
  cells[place + ".navigation_error_m"] = figures.navigation_error_m;
  cells[place + ".navigation_velocity_error_mps"] = figures.navigation_velocity_error_mps;
  cells[place + ".control_error_m"] = figures.control_error_m;
}

template <class Waypoints>
void add_waypoints(Cells& cells, const char* table, const Waypoints& waypoints) {
  for (const auto& waypoint : waypoints) {
    add(cells, fmt::format("{}.sil.waypoint_{}", table, waypoint.index), waypoint.figures.software);
    add(cells, fmt::format("{}.hil.waypoint_{}", table, waypoint.index), waypoint.figures.hardware);
  }
}

void add_mean(Cells& cells, const std::string& name, const char* unit, const MeanAndDeviation& value) {
  cells[fmt::format("{}_mean_{}", name, unit)] = value.mean;
  cells[fmt::format("{}_std_{}", name, unit)] = value.std;
}

template <class Totals>
void add_totals(Cells& cells, const std::string& place, const Totals& totals) {
  cells[place + ".dv_mps"] = totals.dv_mps;
  cells[place + ".maneuvers"] = totals.maneuvers;
}

void add_means(Cells& cells, const std::string& place, const paper2::Totals& totals) {
  add_mean(cells, place + ".navigation_error", "m", totals.navigation_error_m);
  add_mean(cells, place + ".attitude_error", "deg", totals.attitude_error_deg);
}

void add_means(Cells& cells, const std::string& place, const paper3::Totals& totals) {
  add_mean(cells, place + ".navigation_error", "m", totals.navigation_error_m);
  add_mean(cells, place + ".navigation_velocity_error", "mps", totals.navigation_velocity_error_mps);
}

Cells all_cells() {
  Cells cells;
  add_waypoints(cells, "table_8", paper1::kWaypoints);
  add_waypoints(cells, "table_9", paper2::kWaypoints);
  add_waypoints(cells, "table_10", paper3::kWaypoints);
  add_means(cells, "table_9.sil.whole", paper2::kSoftware);
  add_means(cells, "table_9.hil.whole", paper2::kHardware);
  add_means(cells, "table_10.sil.whole", paper3::kSoftware);
  add_means(cells, "table_10.hil.whole", paper3::kHardware);
  add_totals(cells, "figure_8.sil", paper1::kSoftware);
  add_totals(cells, "figure_8.hil", paper1::kHardware);
  add_totals(cells, "figure_13.sil", paper2::kSoftware);
  add_totals(cells, "figure_13.hil", paper2::kHardware);
  add_totals(cells, "figure_16.sil", paper3::kSoftware);
  add_totals(cells, "figure_16.hil", paper3::kHardware);
  return cells;
}

}  // namespace

const Cells& paper_cells() {
  static const Cells kCells = all_cells();
  return kCells;
}

std::optional<double> find_paper_cell(const std::string& name) {
  const auto found = paper_cells().find(name);
  return found == paper_cells().end() ? std::nullopt : std::optional(found->second);
}

}  // namespace vbar::report
