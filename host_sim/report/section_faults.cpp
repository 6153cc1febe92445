// Faults of the scenario, with the observed effects, and fault events of the flight software.

#include <fmt/format.h>

#include "host_sim/report/csv_table.h"
#include "host_sim/report/html_page.h"
#include "host_sim/report/report_sections.h"
#include "host_sim/report/run_columns.h"
#include "host_sim/report/section_parts.h"

namespace vbar::report {
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
