// Cost of the campaign, and the processors on which it was flown.

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>

#include "host_sim/campaign_report/case_text.h"
#include "host_sim/campaign_report/distribution_plots.h"
#include "host_sim/campaign_report/sections.h"
#include "host_sim/report/number_text.h"
#include "host_sim/report/statistics.h"

namespace vbar::campaign_report {
namespace {

constexpr std::size_t kMaxRows = 30;

struct Usage {
  std::set<std::string> hosts;
  std::vector<double> cpu_s;
};

std::map<std::string, Usage> by_processor(const Campaign& campaign) {
  std::map<std::string, Usage> all;
  for (const Case& one : campaign.cases) {
    if (!std::isfinite(one.cpu_s)) continue;
    Usage& usage = all[one.processor];
    usage.hosts.insert(one.host);
    usage.cpu_s.push_back(one.cpu_s);
  }
  return all;
}

std::vector<std::string> row_of(const std::string& processor, Usage usage) {
  std::ranges::sort(usage.cpu_s);
  const double mean = *report::mean_of(usage.cpu_s);
  return {processor.empty() ? "(not given)" : processor,
          report::grouped(usage.hosts.size()),
          report::grouped(usage.cpu_s.size()),
          report::duration_text(mean * static_cast<double>(usage.cpu_s.size())),
          report::duration_text(report::quantile(usage.cpu_s, 0.5)),
          report::duration_text(report::quantile(usage.cpu_s, 0.95)),
          report::duration_text(usage.cpu_s.back())};
}

std::vector<report::Fact> facts(const Campaign& campaign) {
  double wall_s = 0.0, cpu_s = 0.0;
  std::uint64_t attempts = 0;
  for (const Case& one : campaign.cases) {
    wall_s += std::isfinite(one.wall_s) ? one.wall_s : 0.0;
    cpu_s += std::isfinite(one.cpu_s) ? one.cpu_s : 0.0;
    attempts += one.attempts;
  }
  const auto repeated = count_cases(campaign, [](const Case& one) { return one.attempts > 1; });
  return {{"processor time of all cases", report::duration_text(cpu_s)},
          {"wall-clock time of all cases", report::duration_text(wall_s)},
          {"attempts", report::grouped(attempts)},
          {"cases with several attempts", report::grouped(repeated)}};
}

}  // namespace

report::Section processor_section(const Content& content) {
  const std::map<std::string, Usage> all = by_processor(content.campaign);
  if (all.empty()) return {};
  std::vector<std::vector<std::string>> rows;
  std::vector<report::Plot> plots;
  for (const auto& [processor, usage] : all) {
    if (rows.size() < kMaxRows) rows.push_back(row_of(processor, usage));
    if (plots.size() == 3) continue;
    Quantity quantity{"cpu_s", {}, {}, usage.cpu_s};
    plots.push_back(histogram(quantity, sorted_values(quantity)));
    plots.back().title = "processor time of a case" + (all.size() > 1 ? ", " + processor : "");
    plots.back().x.name = "processor time, s";
  }
  std::string body = report::fact_list(facts(content.campaign));
  if (all.size() > 1)
    body += "<p class=\"note\">Results may differ in their last bits between types of processors.</p>\n";
  return {"Time and processors",
          body +
              report::table({{"processor", false},
                             {"hosts"},
                             {"cases"},
                             {"processor time"},
                             {"median of a case"},
                             {"95 %"},
                             {"longest"}},
                            rows) +
              report::plot_rows(3, std::move(plots)),
          {"results.csv"}};
}

}  // namespace vbar::campaign_report
