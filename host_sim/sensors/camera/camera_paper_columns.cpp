// The paper's experiments 1 and 2 as columns of a comparison.

#include "host_sim/report/mission_views.h"
#include "host_sim/report/paper_experiment1.h"
#include "host_sim/report/paper_experiment2.h"
#include "host_sim/sensors/camera/camera_report.h"

namespace vbar::sensors {
namespace {

using namespace report;  // NOLINT(google-build-using-namespace): a column is made of its parts

template <class Waypoints, class Totals>
PaperColumn paper_column(const char* name, const Waypoints& waypoints, paper1::Loop paper1::Loops::*loop,
                         const Totals& totals) {
  PaperColumn column;
  column.name = name;
  column.at = [&waypoints, loop](const WaypointRow& row) {
    PaperColumn::AtWaypoint at;
    if (const paper1::Loops* const same = at_waypoint(waypoints, row)) {
      at.control_error_m = (same->*loop).control_error_m;
      at.navigation_error_m = (same->*loop).navigation_error_m;
    }
    return at;
  };
  column.dv_mps = totals.dv_mps;
  column.maneuvers = totals.maneuvers;
  return column;
}

PaperColumn paper_column(const char* name, paper1::Loop paper1::Loops::*loop, const paper2::Totals& totals) {
  PaperColumn column = paper_column(name, paper2::kWaypoints, loop, totals);
  column.navigation_error_m = totals.navigation_error_m;
  column.attitude_error_deg = totals.attitude_error_deg;
  return column;
}

}  // namespace

std::vector<PaperColumn> camera_paper_columns(const RunRecord& record) {
  const std::vector<WaypointRow> waypoints = reached_waypoints(record);
  const std::string& navigation = record.summary.navigation;
  if (navigation == "angles_only" && meets_paper(paper1::kWaypoints, waypoints))
    return {paper_column(kPaperSoftware, paper1::kWaypoints, &paper1::Loops::software, paper1::kSoftware),
            paper_column(kPaperHardware, paper1::kWaypoints, &paper1::Loops::hardware, paper1::kHardware)};
  if (navigation == "pose" && meets_paper(paper2::kWaypoints, waypoints))
    return {paper_column(kPaperSoftware, &paper1::Loops::software, paper2::kSoftware),
            paper_column(kPaperHardware, &paper1::Loops::hardware, paper2::kHardware)};
  return {};
}

}  // namespace vbar::sensors
