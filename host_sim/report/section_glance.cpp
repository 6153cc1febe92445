// The whole run in one figure: how far, how well known, by which sources, with which burns.

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "host_sim/report/csv_table.h"
#include "host_sim/report/html_page.h"
#include "host_sim/report/navigation_errors.h"
#include "host_sim/report/report_sections.h"
#include "host_sim/report/run_columns.h"
#include "host_sim/report/section_parts.h"
#include "host_sim/report/timeline.h"

namespace vbar::report {
namespace {

constexpr int kWarningColour = 6;
constexpr double kNarrowestBand = 0.003;  // share of the figure's width: a fault of seconds is seen, too

Plot distance_plot(const RunRecord& record) {
  const View whole = whole_run(record);
  Plot plot = time_plot(whole, "Distance to the target, and the accuracy of navigation", "distance", Unit::kMetres,
                        340.0, &record);
  plot.y.logarithmic = true;
  const std::vector<NavigationError> errors = navigation_errors(record);
  const auto bound = [](const NavigationError& e) {
    return 3.0 * magnitude({e.sigma_rtn[0], e.sigma_rtn[1], e.sigma_rtn[2]});
  };
  const auto error = [](const NavigationError& e) { return magnitude(e.position_rtn); };
  plot.series = {{"true distance", 0, Mark::kLine,
                  over_time(record.truth, whole, [](const TruthRow& r) { return magnitude(r.relative_position_rtn); })},
                 {"3σ of the filter, of the relative position", 1, Mark::kLine, over_time(errors, whole, bound)},
                 {"error of the relative position", 2, Mark::kLine, over_time(errors, whole, error)}};
  return plot;
}

/// Returns the band where a source aids, starts or is suspended; empty where it waits or is off.
std::optional<Band> band_of(int state) {
  switch (state) {
    case telemetry_event::kAidStarting:
      return Band{.colour = 3, .text = "starting"};
    case telemetry_event::kAidAiding:
      return Band{.colour = 0, .text = "aiding"};
    case telemetry_event::kAidSuspended:
      return Band{.colour = 5, .text = "suspended"};
    case telemetry_event::kAidFailed:
      return Band{.colour = kWarningColour, .text = "failed"};
    default:
      return std::nullopt;
  }
}

/// Made from the events of its changes, in order of time.
std::vector<Band> bands_of(const std::vector<TelemetryRow<telemetry_event>>& events, std::int32_t source,
                           double end_h) {
  std::vector<Band> bands;
  std::optional<Band> open;
  const auto close = [&](double time_h) {
    if (!open) return;
    open->end_h = time_h;
    bands.push_back(*open);
  };
  for (const auto& [time_s, step_time_s, event] : events) {
    if (event.event != telemetry_event::kEventAid || event.device != source) continue;
    close(hours(time_s));
    open = band_of(event.after);
    if (open) open->start_h = hours(time_s);
  }
  close(end_h);
  return bands;
}

/// Faults of the scenario, and the retreat if it was flown.
std::vector<TimelineRow> fault_rows(const RunRecord& record, const Range& all) {
  const double narrowest_h = kNarrowestBand * (all.high - all.low);
  const auto band = [&](double from_s, const std::optional<double>& to_s, std::string text) {
    const double from_h = hours(from_s);
    const double to_h = to_s ? hours(*to_s) : all.high;
    return Band{.start_h = from_h,
                .end_h = std::min(std::max(to_h, from_h + narrowest_h), all.high),
                .colour = kWarningColour,
                .text = std::move(text)};
  };
  std::vector<TimelineRow> rows;
  for (const FaultRow& fault : record.faults)
    if (fault.begin_s) rows.push_back({"fault: " + fault.name, {band(*fault.begin_s, fault.end_s, fault.kind)}});
  std::vector<Band> retreats;
  double begun_s = 0.0;
  bool is_flown = false;
  for (const auto& [time_s, step_time_s, event] : record.of<telemetry_event>()) {
    if (event.fault != telemetry_health::kFaultRetreat) continue;
    if (event.event == telemetry_event::kEventFaultRaised) {
      begun_s = time_s;
      is_flown = true;
    } else if (event.event == telemetry_event::kEventFaultEnded && is_flown) {
      retreats.push_back(band(begun_s, time_s, "retreat"));
      is_flown = false;
    }
  }
  if (is_flown) retreats.push_back(band(begun_s, std::nullopt, "retreat"));
  if (!retreats.empty()) rows.push_back({"retreat", retreats});
  return rows;
}

std::string aids(const RunRecord& record) {
  const auto& events = record.of<telemetry_event>();
  std::vector<std::int32_t> sources;
  for (const auto& row : events)
    if (row.message.event == telemetry_event::kEventAid) sources.push_back(row.message.device);
  std::ranges::sort(sources);
  sources.erase(std::unique(sources.begin(), sources.end()), sources.end());
  const Range all = hours_of(whole_run(record));
  std::vector<TimelineRow> rows;
  for (const std::int32_t source : sources)
    rows.push_back(
        {word_of(columns::words(codes::navigation_configuration_kUse), source), bands_of(events, source, all.high)});
  const std::vector<TimelineRow> faults = fault_rows(record, all);
  rows.insert(rows.end(), faults.begin(), faults.end());
  const std::string_view note = faults.empty() ? "Sources of navigation:" : "Sources of navigation, and faults:";
  return rows.empty() ? "" : fmt::format("<p class=\"note\">{}</p>\n", note) + figures(1, {timeline(rows, all)});
}

}  // namespace

Section glance_section(const RunRecord& record) {
  if (record.estimates.empty() || record.truth.empty()) return {};
  return {"Mission at a glance",
          kPlotNote + plot_rows(1, {distance_plot(record)}) + aids(record),
          {"truth.csv", "estimate.csv", "telemetry_event.csv"}};
}

}  // namespace vbar::report
