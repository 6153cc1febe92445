#include <algorithm>
#include <array>
#include <initializer_list>
#include <string>

#include <fmt/format.h>

#include "host_sim/report/csv_table.h"
#include "host_sim/report/plots/html_page.h"
#include "host_sim/report/plots/number_text.h"
#include "host_sim/report/run_columns.h"
#include "host_sim/report/sections/sections.h"
#include "host_sim/report/summarise.h"

namespace vbar::report {

namespace {

std::string step_cost(const RunRecord& record) {
  const Summary::FlightStep& step = record.summary.flight_step;
  if (step.unit == "none" || step.max == 0) {
    return fmt::format("<p>{} flight steps; this flight computer does not count instructions.</p>\n",
                       grouped(step.count));
  }
  const View whole = whole_run(record);
  Plot plot = time_plot(whole, fmt::format("{} of each flight step", step.unit), step.unit, Unit::kNone, 240.0);
  plot.y.range = Range{0.0, 1.05 * static_cast<double>(step.max)};
  plot.series = {{step.unit, 0, Mark::kDots, over_time(record.estimates, whole, [](const EstimateRow& r) {
                    return static_cast<double>(r.step_cost);
                  })}};
  return fmt::format("<p>{} flight steps: at most {}, on average {} {}; at most {} bytes of stack.</p>\n",
                     grouped(step.count), grouped(step.max), grouped_nearest(step.mean), step.unit,
                     grouped(step.stack_bytes_max)) +
         plot_rows(1, {std::move(plot)});
}

std::string share_of_step(const Summary::Link& link) {
  if (link.baud == 0) return "–";
  return fmt::format("at most {} %, on average {} % at {} baud", fixed(100.0 * link.step_share_max, 2),
                     fixed(100.0 * link.step_share_mean, 2), grouped(static_cast<std::uint64_t>(link.baud)));
}

/// "3 resent, 1 rejected"; the text for none if all counts are zero.
struct Count {
  const char* what;
  std::uint64_t value;
};
Fact counts(const char* name, std::initializer_list<Count> all) {
  std::string text;
  for (const Count& count : all) {
    if (count.value == 0) continue;
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", grouped(count.value), count.what);
  }
  return {name, text.empty() ? "none" : text, !text.empty()};
}

/// Adds one row without bytes: there was no link, as the flight software ran in this process.
void add_link(const Summary::Link& link, std::vector<Fact>& facts) {
  if (link.bytes == 0) {
    facts.push_back({"link", "none: flight software in the same process"});
    return;
  }
  facts.push_back({"bytes on the link", grouped(link.bytes)});
  facts.push_back({"share of a step on the line", share_of_step(link)});
  facts.push_back(counts("irregular frames", {{"resent", link.frames_resent},
                                              {"rejected", link.frames_rejected},
                                              {"duplicated", link.frames_duplicated},
                                              {"foreign", link.strangers_ignored}}));
  if (link.wired_bytes + link.wired_timeouts == 0) return;
  facts.push_back({"bytes of the receiver on the board's own line", grouped(link.wired_bytes)});
  facts.push_back(counts("irregularities of that line", {{"bytes missing", link.wired_bytes_missing},
                                                         {"bytes dropped", link.wired_bytes_dropped},
                                                         {"timeouts", link.wired_timeouts}}));
}

/// Shares that add up to 100 % of their sum.
void add_wall_clock(const Summary& s, std::vector<Fact>& facts) {
  const std::vector<double> parts{s.wall_share.truth_s, s.wall_share.flight_s, s.wall_share.link_s,
                                  s.wall_share.other_s};
  constexpr std::array kNames{"wall clock: truth", "wall clock: flight computer", "wall clock: link",
                              "wall clock: other"};
  const std::vector<double> shares = percentages(parts);
  for (std::size_t k = 0; k < kNames.size(); ++k)
    facts.push_back({kNames[k], fmt::format("{} s ({} %)", fixed(std::max(parts[k], 0.0), 2), fixed(shares[k], 1))});
  if (s.camera.empty()) return;
  facts.push_back({"camera thread, in parallel",
                   fmt::format("rendering {} s, detector {} s, packing {} s", fixed(s.wall_share.render_s, 2),
                               fixed(s.wall_share.detector_s, 2), fixed(s.wall_share.packing_s, 2))});
}

}  // namespace

Section computer_section(const RunRecord& record) {
  const Summary& s = record.summary;
  std::vector<Fact> facts;
  add_link(s.link, facts);
  facts.push_back(counts("deadlines missed", {{"by the flight step", s.deadlines.compute_overruns},
                                              {"by the wake-up", s.deadlines.wakeups_late},
                                              {"by the link", s.deadlines.link_late},
                                              {"by the simulation", s.deadlines.simulation_late}}));
  add_wall_clock(s, facts);
  return {"Flight computer, link and time", step_cost(record) + fact_list(facts), {"estimate.csv"}};
}

Section health_section(const RunRecord& record) {
  const std::optional<telemetry_health>& health = record.summary.health;
  const std::string output = output_line(record.summary);
  if (!health && output.empty()) return {};
  std::string text = output.empty() ? "" : "<p>" + escaped("The flight software: " + output + ".") + "</p>\n";
  if (!health) return {"Health of the flight software", text};
  std::vector<Fact> facts;
  visit_fields(*health, [&](const Field& field, const auto& value) {
    std::string name = field.name;
    if (name == "step") return;
    std::ranges::replace(name, '_', ' ');
    const auto number = static_cast<int>(value);
    facts.push_back({name, field.codes.count > 0 ? word_of(field.codes, number) : std::to_string(number)});
  });
  const std::string line = health_line(*health);
  text += "<p>" +
          escaped(line.empty() ? "The flight software rejected and dropped no packet and raised no fault."
                               : "Not nominal: " + line + ".") +
          "</p>\n" + fact_list(facts);
  return {"Health of the flight software", text};
}

// Faults of the scenario, with the observed effects, and fault events of the flight software.

namespace {

constexpr std::size_t kMostEvents = 200;

std::string hours_text(double time_s) {
  return fmt::format("{:.4f}", hours(time_s));
}
std::string hours_text(const std::optional<double>& time_s) {
  return time_s ? hours_text(*time_s) : "–";
}

std::string injected(const RunRecord& record) {
  if (record.faults.empty()) return "";
  std::vector<std::vector<std::string>> rows;
  for (const FaultRow& fault : record.faults) {
    rows.push_back({fault.name, fault.kind, fault.unit, fault.event,
                    fault.begin_s ? hours_text(fault.begin_s) : "never", hours_text(fault.end_s),
                    fault.effect_s ? hours_text(fault.effect_s) : "never", hours_text(fault.recovered_s),
                    fault.evidence});
  }
  return "<p class=\"note\">Faults of the scenario; effect and recovery are those that packets and truth show. "
         "Recovered is when the data were right and their sources aided navigation as before:</p>\n" +
         table({{"fault", false},
                {"kind", false},
                {"unit", false},
                {"event", false},
                {"begins, h"},
                {"ends, h"},
                {"effect, h"},
                {"recovered, h"},
                {"evidence", false}},
               rows);
}

bool is_of_fault(const telemetry_event& event) {
  return event.event == telemetry_event::kEventFaultRaised || event.event == telemetry_event::kEventFaultEnded ||
         event.event == telemetry_event::kEventFaultCleared;
}

std::string reported(const RunRecord& record) {
  std::vector<std::vector<std::string>> rows;
  std::size_t more = 0;
  for (const auto& [time_s, step_time_s, event] : record.of<telemetry_event>()) {
    if (!is_of_fault(event)) continue;
    if (rows.size() == kMostEvents) {
      ++more;
      continue;
    }
    rows.push_back(
        {hours_text(time_s), word_of(columns::words(codes::telemetry_event_kEvent), event.event),
         word_of(columns::words(codes::telemetry_health_kFault), event.fault),
         event.device == 0 ? "" : word_of(columns::words(codes::navigation_configuration_kUse), event.device),
         fmt::format("{:.4g}", event.argument)});
  }
  if (rows.empty()) return "";
  std::string text = "<p class=\"note\">Reported by the flight software:</p>\n" +
                     table({{"time, h"}, {"event", false}, {"fault", false}, {"source", false}, {"argument"}}, rows);
  if (more > 0) text += fmt::format("<p class=\"note\">and {} more: telemetry_event.csv</p>\n", more);
  return text;
}

}  // namespace

Section faults_section(const RunRecord& record) {
  const std::string text = injected(record) + reported(record);
  if (text.empty()) return {};
  return {"Faults", text, {"faults.csv", "telemetry_event.csv"}};
}

}  // namespace vbar::report
