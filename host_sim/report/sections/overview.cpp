#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "host_sim/report/csv_table.h"
#include "host_sim/report/plots/html_page.h"
#include "host_sim/report/plots/number_text.h"
#include "host_sim/report/plots/svg_plot.h"
#include "host_sim/report/run_columns.h"
#include "host_sim/report/run_series.h"
#include "host_sim/report/sections/sections.h"
#include "host_sim/report/statistics.h"
#include "host_sim/report/verdict.h"
#include "host_sim/report/words.h"

namespace vbar::report {

namespace {

std::string badge(const char* style, std::string_view word, const std::string& text, const char* text_style = "") {
  return fmt::format("<p><span class=\"status {}\">{}</span> <span class=\"{}\">{}</span></p>\n", style, escaped(word),
                     text_style, escaped(text));
}

std::string status(const Summary& s) {
  if (!s.complete) return badge("bad", "incomplete", s.incomplete_reason, "bad");
  // An older version of this program left no verdict.
  if (s.verdict_reason.empty())
    return badge(s.never_navigated ? "bad" : "good", s.never_navigated ? "never navigated" : "complete", "");
  const Outcome outcome = outcome_of(s.verdict);
  if (!is_favourable(outcome)) return badge("bad", s.verdict, s.verdict_reason, "bad");
  return badge(outcome == Outcome::kAchieved ? "good" : "caution", s.verdict, s.verdict_reason);
}

std::string tile(std::string_view value, std::string_view meaning) {
  return fmt::format("<div class=\"tile\"><b>{}</b><span>{}</span></div>\n", escaped(value), escaped(meaning));
}

std::string tiles(const RunRecord& record) {
  const Summary& s = record.summary;
  std::string out = "<div class=\"tiles\">\n";
  out += tile(measure_text(s.dv_mps, "m/s"), fmt::format("delta-v in {} maneuvers", s.maneuvers));
  const std::vector<WaypointRow> reached = reached_waypoints(record);
  if (!reached.empty()) {
    const WaypointRow& last = reached.back();
    out += tile(measure_text(last.control_error_m, "m"), fmt::format("control error at waypoint {}", last.index));
    const auto worst = std::ranges::max_element(reached, {}, &WaypointRow::control_error_m);
    out += tile(measure_text(worst->control_error_m, "m"),
                fmt::format("largest control error (waypoint {})", worst->index));
  }
  if (s.navigation_error_m) out += tile(measure_text(s.navigation_error_m->mean, "m"), "mean navigation error");
  out += tile(duration_text(s.simulated_s), fmt::format("simulated in {}", duration_text(s.wall_s)));
  out += tile(fmt::format("{}×", grouped_nearest(s.speed_factor)), "real time");
  return out + "</div>\n";
}

std::string or_none(const std::string& text) {
  return text.empty() ? "none" : text;
}

/// What navigation had: "angles_only, camera digital".
std::string flown_with(const Summary& s) {
  std::string text = s.navigation.empty() ? "" : fmt::format("navigation {}", s.navigation);
  for (const auto& [name, kind] : {std::pair{"camera", s.camera}, std::pair{"GNSS", s.gnss}})
    if (!kind.empty()) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name, kind);
  return text;
}

/// Appends nothing for a folder of an older version, which has no provenance.
void append_provenance(const Provenance& provenance, std::vector<Fact>& facts) {
  if (provenance.vbar_version.empty()) return;
  facts.push_back({"vbar", fmt::format("{}, commit {}", provenance.vbar_version, or_none(provenance.commit))});
  facts.push_back({"build", fmt::format("{}, {}", provenance.compiler, provenance.build_type)});
  facts.push_back({"host", provenance.host});
  facts.push_back({"started, UTC", provenance.started_utc});
  facts.push_back({"mission epoch, UTC", provenance.epoch_utc});
  facts.push_back({"overrides", or_none(fmt::format("{}", fmt::join(provenance.overrides, ", ")))});
}

}  // namespace

std::string overview(const RunRecord& record) {
  const Summary& s = record.summary;
  const std::string with = flown_with(s);
  std::string out = fmt::format("<h1>{}</h1>\n<p class=\"lead\">seed {}, flown on {}{}{}</p>\n", escaped(s.mission),
                                s.seed, escaped(s.flight_computer), with.empty() ? "" : "; ", escaped(with));
  out += status(s);
  for (const std::string& testbed : emulated_testbeds(s))
    out +=
        badge("caution", "emulated bench", fmt::format("The testbed {} was emulated; no hardware was used.", testbed));
  out += tiles(record);
  std::vector<Fact> facts;
  for (const std::string& note : s.data_notes) facts.push_back({"data", note, true});
  for (const SourceFigures& source : s.sources)
    if (source.failures > 0)
      facts.push_back({"failures of " + source.name, fmt::format("{} of {} epochs; the last: {}", source.failures,
                                                                 source.epochs, source.last_failure)});
  for (const SourceFigures& source : s.sources)
    if (source.packets_rejected > 0)
      facts.push_back({"packets of " + source.name,
                       fmt::format("{} of impossible times or values were rejected", source.packets_rejected), true});
  return facts.empty() ? out : out + fact_list(facts);
}

Section flown_section(const RunRecord& record) {
  const Summary& s = record.summary;
  std::vector<Fact> facts{{"flight computer", s.flight_computer},
                          {"flight software", s.flight_software},
                          {"navigation", or_none(s.navigation)},
                          {"camera", or_none(s.camera)},
                          {"GNSS", or_none(s.gnss)},
                          {"seed", std::to_string(s.seed)},
                          {"commands SHA-256", s.commands_sha256},
                          {"telemetry SHA-256", s.telemetry_sha256}};
  append_provenance(s.provenance, facts);
  for (const SourceFigures& source : s.sources)
    if (source.name == "truth")
      facts.push_back({"truth", fmt::format("of testbed {}, {} answers", source.kind, source.epochs)});
  return {"What was flown", fact_list(facts), {"summary.json"}};
}

// The whole run in one figure: how far, how well known, by which sources, with which burns.

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
