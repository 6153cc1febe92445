#include "host_sim/report/sections/html_report.h"

#include <algorithm>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "host_sim/files/output_file.h"
#include "host_sim/report/extension.h"
#include "host_sim/report/plots/html_page.h"
#include "host_sim/report/plots/number_text.h"
#include "host_sim/report/run_folder.h"
#include "host_sim/report/sections/sections.h"
#include "host_sim/report/words.h"

namespace vbar::report {

namespace {

std::optional<double> millimetres(const std::optional<double>& metres) {
  return metres ? std::optional(1e3 * *metres) : std::nullopt;
}

}  // namespace

std::string waypoint_table(const RunRecord& record) {
  constexpr auto kHead = "{:>8} {:>9} {:>14} {:>17} {:>17} {:>12} {:>12} {:>10}\n";
  std::string text;
  for (const std::string& testbed : emulated_testbeds(record.summary))
    text += fmt::format("figures of an emulated bench: the testbed {} was emulated\n", testbed);
  text +=
      fmt::format(kHead, "", "time", "control error", "navigation error", "velocity error", "leg dv", "total dv", "");
  text += fmt::format(kHead, "waypoint", "h", "m", "m", "mm/s", "m/s", "m/s", "maneuvers");
  for (const WaypointRow& row : record.waypoints) {
    const bool is_first = is_start(record, row);
    const std::optional<double> control_error_m = is_first ? std::nullopt : std::optional(row.control_error_m);
    text += fmt::format("{:>8} {:>9.3f} {:>14} {:>17} {:>17} {:>12.6f} {:>12.6f} {:>10}\n",
                        is_first ? fmt::format("start {}", row.index) : std::to_string(row.index), row.time_s / 3600.0,
                        fixed(control_error_m, 4), fixed(row.navigation_error_m, 4),
                        fixed(millimetres(row.navigation_velocity_error_mps), 4), row.leg_dv_mps, row.cumulative_dv_mps,
                        row.leg_maneuvers);
  }
  const Summary& s = record.summary;
  text += fmt::format("{:>8} {:>9.3f} {:>14} {:>17} {:>17} {:>12} {:>12.6f} {:>10}\n", s.complete ? "all" : "stopped",
                      s.simulated_s / 3600.0, "", "", "", "", s.dv_mps, s.maneuvers);
  return text;
}

std::string html_report(const RunRecord& record, std::string_view note) {
  std::vector<Section> sections{glance_section(record),     faults_section(record),   waypoint_section(record),
                                trajectory_section(record), elements_section(record), maneuver_section(record),
                                navigation_section(record)};
  for (const Extension* extension : record.extensions) {
    if (extension->sections == nullptr) continue;
    for (Section& section : extension->sections(record)) sections.push_back(std::move(section));
  }
  for (auto* const section : {attitude_section, guidance_section, health_section, computer_section, flown_section})
    sections.push_back(section(record));
  std::string body = overview(record);
  if (!note.empty()) body += fmt::format("<p>{}</p>\n", note);
  body += contents(sections);
  for (const Section& section : sections) body += section_html(section);
  return html_page(fmt::format("{} (seed {})", record.summary.mission, record.summary.seed), body);
}

std::filesystem::path write_html_report(const std::filesystem::path& run_folder, const RunRecord& record,
                                        std::string_view note) {
  std::filesystem::path file = report_file(run_folder);
  files::replace_text_file(file, html_report(record, note));
  return file;
}

}  // namespace vbar::report
