// Experiment 1 beside the figures of the paper.

#include <functional>
#include <optional>

#include <fmt/format.h>

#include "host_sim/report/html_page.h"
#include "host_sim/report/loop_name.h"
#include "host_sim/report/mission_views.h"
#include "host_sim/report/number_text.h"
#include "host_sim/report/paper_experiment1.h"
#include "host_sim/sensors/camera/camera_report.h"

namespace vbar::sensors {
namespace {

using namespace report;  // NOLINT(google-build-using-namespace): a section is made of its parts

struct Metric {
  const char* name;
  std::function<std::optional<double>(const WaypointRow&)> value;
  double paper1::Loop::*papers_value;
};

const std::vector<Metric> kMetrics{
    {"navigation error, m", [](const WaypointRow& row) { return row.navigation_error_m; },
     &paper1::Loop::navigation_error_m},
    {"control error, m", [](const WaypointRow& row) { return row.control_error_m; }, &paper1::Loop::control_error_m}};

std::vector<std::string> papers_row(const std::vector<WaypointRow>& waypoints, const char* loop, const Metric& metric,
                                    paper1::Loop paper1::Loops::*which) {
  std::vector<std::string> cells{"", loop};
  for (const WaypointRow& row : waypoints) {
    const paper1::Loops* const same = at_waypoint(paper1::kWaypoints, row);
    cells.push_back(fixed(same != nullptr ? std::optional((same->*which).*metric.papers_value) : std::nullopt, 2));
  }
  return cells;
}

std::string text_of(const paper1::Totals& totals) {
  return fmt::format("{:.2f} in {} maneuvers", totals.dv_mps, totals.maneuvers);
}

}  // namespace

std::string angles_only_performance(const RunRecord& record) {
  const std::vector<WaypointRow> waypoints = reached_waypoints(record);
  std::vector<Column> columns{{"", false}, {"", false}};
  for (const WaypointRow& row : waypoints) columns.push_back({fmt::format("waypoint {}", row.index)});
  const bool has_paper = meets_paper(paper1::kWaypoints, waypoints);
  const std::string own = emulated_testbeds(record.summary).empty() ? kThisRun : "this run, emulated bench";
  std::vector<std::vector<std::string>> rows;
  for (const Metric& metric : kMetrics) {
    std::vector<std::string>& cells = rows.emplace_back(std::vector<std::string>{metric.name, own});
    for (const WaypointRow& row : waypoints) cells.push_back(fixed(metric.value(row), 2));
    if (!has_paper) continue;
    rows.push_back(papers_row(waypoints, kPaperSoftware, metric, &paper1::Loops::software));
    rows.push_back(papers_row(waypoints, kPaperHardware, metric, &paper1::Loops::hardware));
  }
  std::string out = waypoints.empty() ? "" : table(columns, rows);
  const Summary& s = record.summary;
  out += fmt::format("<p>Delta-v: {} m/s in {} maneuvers", fixed(s.dv_mps, 3), s.maneuvers);
  if (has_paper)
    out += fmt::format("; paper: {} (software in the loop) and {} (hardware in the loop)", text_of(paper1::kSoftware),
                       text_of(paper1::kHardware));
  return out + ".</p>\n";
}

}  // namespace vbar::sensors
