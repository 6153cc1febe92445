#include "host_sim/campaign_report/write_page.h"

#include "host_sim/campaign_report/read_campaign.h"
#include "host_sim/campaign_report/sections.h"
#include "host_sim/report/html_page.h"
#include "host_sim/report/text_file.h"

namespace vbar::campaign_report {

std::string page_of(const Campaign& campaign, const std::string& folder_name) {
  const Content content{campaign, quantities(campaign), folder_name};
  std::vector<report::Section> sections;
  for (auto* const section : {pass_rate_section, distribution_section, miss_section, consistency_section,
                              driver_section, worst_section, failure_section, processor_section})
    sections.push_back(section(content));
  std::string body = overview(content) + report::contents(sections);
  for (const report::Section& section : sections) body += report::section_html(section);
  return report::html_page(campaign.name, body);
}

}  // namespace vbar::campaign_report

namespace vbar::campaign {

std::filesystem::path write_page(const std::filesystem::path& folder) {
  const campaign_report::Campaign campaign = campaign_report::read_campaign(folder);
  const std::filesystem::path whole = std::filesystem::absolute(folder).lexically_normal();
  const std::filesystem::path name = whole.has_filename() ? whole.filename() : whole.parent_path().filename();
  std::filesystem::path page = folder / "campaign.html";
  files::replace_text_file(page, campaign_report::page_of(campaign, name.string()));
  return page;
}

}  // namespace vbar::campaign
