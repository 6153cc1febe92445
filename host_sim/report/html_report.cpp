#include "host_sim/report/html_report.h"

#include <utility>

#include <fmt/format.h>

#include "host_sim/report/extension.h"
#include "host_sim/report/html_page.h"
#include "host_sim/report/report_sections.h"
#include "host_sim/report/run_folder.h"
#include "host_sim/report/text_file.h"

namespace vbar::report {

std::string html_report(const RunRecord& record) {
  std::vector<Section> sections{glance_section(record),     faults_section(record),   waypoint_section(record),
                                trajectory_section(record), elements_section(record), maneuver_section(record),
                                navigation_section(record)};
  for (const Extension* extension : record.extensions) {
    if (extension->sections == nullptr) continue;
    for (Section& section : extension->sections(record)) sections.push_back(std::move(section));
  }
  for (auto* const section : {attitude_section, guidance_section, health_section, computer_section})
    sections.push_back(section(record));
  std::string body = overview(record) + contents(sections);
  for (const Section& section : sections) body += section_html(section);
  return html_page(fmt::format("{} (seed {})", record.summary.mission, record.summary.seed), body);
}

std::filesystem::path write_html_report(const std::filesystem::path& run_folder, const RunRecord& record) {
  std::filesystem::path file = report_file(run_folder);
  files::replace_text_file(file, html_report(record));
  return file;
}

}  // namespace vbar::report
