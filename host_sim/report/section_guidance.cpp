#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host_sim/report/code_names.h"
#include "host_sim/report/html_page.h"
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
  const std::vector<TimelineRow> rows{
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
                      })},
      {"closed form", bands(
                          record, [](const EstimateRow& r) { return r.closed_form_status; }, warning_unless_ok)},
      {"Koenig-D'Amico", bands(
                             record, [](const EstimateRow& r) { return r.koenig_damico_status; }, warning_unless_ok)},
      {"least squares", bands(
                            record, [](const EstimateRow& r) { return r.least_squares_status; }, warning_unless_ok)},
      {"passive safety", bands(
                             record, [](const EstimateRow& r) { return r.safety_status; }, warning_unless_ok)}};
  return "<p class=\"note\">The last four rows are empty while all is well.</p>\n" +
         figures(1, {timeline(rows, hours_of(whole_run(record)))});
}

Plot distance_plot(const RunRecord& record) {
  const View whole = whole_run(record);
  Plot plot;
  plot.title = "Distance to the target: now, and the least to come if the plan ended after any of its burns";
  plot.x = time_axis(whole);
  plot.y = {.name = "distance", .unit = Unit::kMetres, .logarithmic = true};
  plot.width = 1190.0;
  plot.height = 280.0;
  plot.moments = waypoint_moments(whole);
  plot.series = {
      {"true distance", 0, Mark::kLine,
       over_time(record.truth, whole,
                 [](const TruthRow& r) {
                   return std::hypot(r.relative_position_rtn[0], r.relative_position_rtn[1],
                                     r.relative_position_rtn[2]);
                 })},
      {"passive safety distance", 1, Mark::kLine,
       over_time(record.estimates, whole, [](const EstimateRow& r) { return r.passive_safety_distance_m; })}};
  return plot;
}

}  // namespace

std::string guidance_section(const RunRecord& record) {
  if (record.estimates.empty() || record.truth.empty()) return {};
  const Plot distances = distance_plot(record);
  return section("Guidance and passive safety",
                 what_was_done_when(record) + legend(distances.series) + figures(1, {svg(distances)}));
}

}  // namespace vbar::report
