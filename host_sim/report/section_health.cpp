#include <algorithm>
#include <string>

#include "host_sim/report/csv_table.h"
#include "host_sim/report/html_page.h"
#include "host_sim/report/report_sections.h"
#include "host_sim/report/summarise.h"

namespace vbar::report {

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

}  // namespace vbar::report
