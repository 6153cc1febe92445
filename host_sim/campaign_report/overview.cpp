// The head of the page: what was asked, how many cases ended how, whether the campaign meets its requirement.

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>

#include "host_sim/campaign_report/page.h"
#include "host_sim/campaign_report/statistics.h"
#include "host_sim/report/plots/number_text.h"
#include "host_sim/report/statistics.h"
#include "host_sim/report/verdict.h"

namespace vbar::campaign_report {

namespace {

std::size_t count_of(const Campaign& campaign, State state) {
  return count_cases(campaign, [state](const Case& one) { return one.state == state; });
}

/// Every case is in it, and each kind that is not complete stands out.
std::string census(const Campaign& campaign) {
  std::string text = fmt::format("<p>{}: {} complete", count_text(campaign.cases.size(), "case", "cases"),
                                 report::grouped(count_of(campaign, State::kComplete)));
  const auto passed = count_cases(campaign, [](const Case& one) { return one.has_passed(); });
  if (!campaign.limits.empty()) text += fmt::format(" ({} passed)", report::grouped(passed));
  const auto add = [&](std::size_t count, std::string_view name) {
    text += count > 0 ? fmt::format(", <span class=\"bad\">{} {}</span>", report::grouped(count), name)
                      : fmt::format(", 0 {}", name);
  };
  add(count_of(campaign, State::kFailed), "failed");
  add(count_of(campaign, State::kOverTime), "over time");
  add(count_of(campaign, State::kLost), "lost");
  add(count_of(campaign, State::kVoid), "void");
  const std::size_t killed = count_of(campaign, State::kKilled), flying = count_of(campaign, State::kFlying),
                    not_begun = count_of(campaign, State::kNotBegun);
  add(killed + flying + not_begun, "not flown to an end");
  if (killed + flying + not_begun > 0)
    text += fmt::format(" ({} killed, {} flying, {} not begun)", killed, flying, not_begun);
  return text + ".</p>\n";
}

/// Returns the number of complete cases with each verdict; empty for results of an older version.
std::string verdicts(const Campaign& campaign) {
  std::map<report::Outcome, std::size_t> counts;
  for (const Case& one : campaign.cases)
    if (one.is_complete() && !one.verdict.empty()) ++counts[report::outcome_of(one.verdict)];
  std::string text;
  for (const auto& [outcome, count] : counts)
    text += fmt::format("{}<span class=\"{}\">{} {}</span>", text.empty() ? "" : ", ",
                        report::is_favourable(outcome) ? "" : "bad", report::grouped(count), report::word_of(outcome));
  return text.empty() ? "" : fmt::format("<p>Verdicts on the mission: {}.</p>\n", text);
}

struct Judgement {
  std::size_t passed = 0, judged = 0;
};

Judgement judgement_of(const Campaign& campaign) {
  return {count_cases(campaign, [](const Case& one) { return one.has_passed(); }),
          count_cases(campaign, [](const Case& one) { return one.is_judged(); })};
}

std::string requirement_text(const Content& content) {
  if (content.requirements.empty()) return {};
  const auto met = std::ranges::count_if(content.requirements, &JudgedRequirement::met);
  return fmt::format("<p><span class=\"status {0}\">{1}</span> {2} of {3} met.</p>\n",
                     all_met(content.requirements) ? "good" : "bad", all_met(content.requirements) ? "met" : "not met",
                     met, count_text(content.requirements.size(), "requirement", "requirements"));
}

/// "0.3.0, commit 4c048e93e2a1"
std::string program_text(const Campaign& campaign) {
  return campaign.vbar_version + (campaign.commit.empty() ? "" : ", commit " + campaign.commit);
}

std::string tile(std::string_view value, std::string_view meaning) {
  return fmt::format("<div class=\"tile\"><b>{}</b><span>{}</span></div>\n", report::escaped(value),
                     report::escaped(meaning));
}

std::string tiles(const Content& content) {
  const Campaign& campaign = content.campaign;
  std::string out = "<div class=\"tiles\">\n";
  const Judgement all = judgement_of(campaign);
  if (all.judged > 0 && !campaign.limits.empty()) {
    const PassRate rate = pass_rate(all.passed, all.judged, kConfidence);
    out += tile(percent(rate.share()),
                fmt::format("passed, {} of {} cases", report::grouped(all.passed), report::grouped(all.judged)));
    if (campaign.is_independent) out += tile(percent(rate.lower), "lower bound, 95 % two-sided");
  }
  for (std::size_t k = 0; k < std::min<std::size_t>(content.quantities.size(), 2); ++k) {
    const Quantity& quantity = content.quantities[k];
    const std::vector<double> sorted = sorted_values(quantity);
    const bool is_low_bad = quantity.min && !quantity.max;
    out += tile(value_text(quantity.key, is_low_bad ? sorted.front() : sorted.back()),
                fmt::format("{} {}", is_low_bad ? "smallest" : "largest", quantity.key));
  }
  double cpu_s = 0.0;
  for (const Case& one : campaign.cases) cpu_s += std::isfinite(one.cpu_s) ? one.cpu_s : 0.0;
  out += tile(report::duration_text(cpu_s), "processor time");
  return out + "</div>\n";
}

}  // namespace

std::string overview(const Content& content) {
  const Campaign& campaign = content.campaign;
  std::string swept, dispersed;
  for (const std::string& key : campaign.keys) {
    const bool is_swept = std::ranges::find(campaign.swept, key) != campaign.swept.end();
    std::string& names = is_swept ? swept : dispersed;
    names.append(names.empty() ? "" : ", ").append(key);
  }
  return fmt::format("<h1>{}</h1>\n{}{}<p class=\"lead\">{}</p>\n", report::escaped(campaign.name), census(campaign),
                     verdicts(campaign), report::escaped(campaign.description)) +
         requirement_text(content) + tiles(content) +
         report::fact_list({{"mission", campaign.mission},
                            {"vbar", program_text(campaign)},
                            {"seeds", campaign.seeds_from.empty() ? "stated" : "drawn from " + campaign.seeds_from},
                            {"swept", swept.empty() ? "no key" : swept},
                            {"dispersed", dispersed.empty() ? "no key" : dispersed},
                            {"program SHA-256", campaign.program_sha256}});
}

// Cost of the campaign, and the processors on which it was flown.

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
