#include <algorithm>

#include <fmt/format.h>

#include "host_sim/report/code_names.h"
#include "host_sim/report/html_page.h"
#include "host_sim/report/maneuver_series.h"
#include "host_sim/report/number_text.h"
#include "host_sim/report/report_sections.h"
#include "host_sim/report/section_parts.h"
#include "host_sim/report/timeline.h"

namespace vbar::report {
namespace {

constexpr int kWarningColour = 6;

/// Stretches over which `code(row)` keeps its value; those for which `describe` gives no text are left out.
template <class Code, class Describe>
std::vector<Band> bands(const RunRecord& record, const Code& code, const Describe& describe) {
  std::vector<Band> all;
  const std::vector<EstimateRow>& rows = record.estimates;
  for (std::size_t first = 0; first < rows.size();) {
    std::size_t next = first + 1;
    while (next < rows.size() && code(rows[next]) == code(rows[first])) ++next;
    Band band = describe(code(rows[first]));
    band.start_h = hours(rows[first].time_s);
    band.end_h = hours(rows[std::min(next, rows.size() - 1)].time_s);
    if (!band.text.empty()) all.push_back(std::move(band));
    first = next;
  }
  return all;
}

Band warning_unless_ok(int status) {
  Band band{.colour = kWarningColour};
  const bool tried = status != telemetry_control::kStatusNotReady;  // it was asked
  if (tried && status != telemetry_control::kStatusOk) band.text = status_name(status);
  return band;
}

std::string what_was_done_when(const RunRecord& record) {
  std::vector<TimelineRow> rows{
      {"mode", bands(
                   record, [](const EstimateRow& r) { return r.mode; },
                   [](int mode) {
                     return Band{.colour = mode == mode_command::kModeApproach ? 0
                                           : mode == mode_command::kModeHold   ? 6
                                                                               : 5,
                                 .text = mode_name(mode)};
                   })},
      {"next waypoint",
       bands(
           record, [](const EstimateRow& r) { return r.waypoint_index; },
           [](int index) { return Band{.colour = 5, .text = index < 0 ? "" : std::to_string(index)}; })},
      {"plan by", bands(
                      record, [](const EstimateRow& r) { return r.active_solver; },
                      [](int solver) {
                        return Band{.colour = std::clamp(solver, 0, 5), .text = solver < 0 ? "" : solver_name(solver)};
                      })}};
  for (const int solver : solvers()) {
    const std::size_t place = place_of_status(solver);
    if (place == kSolverStatuses) continue;
    rows.push_back({solver_name(solver),
                    bands(
                        record, [&](const EstimateRow& r) { return r.solver_status[place]; }, warning_unless_ok)});
  }
  rows.push_back(
      {"passive safety", bands(
                             record, [](const EstimateRow& r) { return r.safety_status; }, warning_unless_ok)});
  return "<p class=\"note\">The rows of the solvers and of passive safety show status codes other than ok.</p>\n" +
         figures(1, {timeline(rows, hours_of(whole_run(record)))});
}

Plot distance_plot(const RunRecord& record) {
  const View whole = whole_run(record);
  Plot plot = time_plot(whole, "Distance to the target, and the minimum if the plan stopped after any of its maneuvers",
                        "distance", Unit::kMetres, 280.0);
  plot.y.logarithmic = true;
  plot.series = {
      {"true distance", 0, Mark::kLine,
       over_time(record.truth, whole, [](const TruthRow& r) { return magnitude(r.relative_position_rtn); })},
      {"passive safety distance", 1, Mark::kLine,
       over_time(record.estimates, whole, [](const EstimateRow& r) { return r.passive_safety_distance_m; })}};
  return plot;
}

}  // namespace

Section guidance_section(const RunRecord& record) {
  if (record.estimates.empty() || record.truth.empty()) return {};
  return {"Guidance and passive safety",
          what_was_done_when(record) + plot_rows(1, {distance_plot(record)}),
          {"estimate.csv", "truth.csv"}};
}

}  // namespace vbar::report
