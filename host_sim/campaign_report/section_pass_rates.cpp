// Pass rates with bounds: all cases, each limit, each point of the sweeps.

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "host_sim/campaign_report/case_text.h"
#include "host_sim/campaign_report/sections.h"
#include "host_sim/campaign_report/sweep.h"
#include "host_sim/report/csv_table.h"
#include "host_sim/report/number_text.h"

namespace vbar::campaign_report {
namespace {

constexpr std::size_t kMaxPoints = 40;  // rows of sweep points

using Row = std::vector<std::string>;

Row row_of(const Campaign& campaign, const std::string& name, std::size_t passed, std::size_t of) {
  if (of == 0) return {name, "0", "0", "–", "–"};
  const PassRate rate = pass_rate(passed, of, kConfidence);
  return {name, report::grouped(of), report::grouped(passed), percent(rate.share()),
          campaign.is_independent ? bounds_text(rate) : "–"};
}

void add_all(const Campaign& campaign, std::vector<Row>& rows) {
  const auto judged = count_cases(campaign, [](const Case& c) { return c.is_judged(); });
  const auto passed = count_cases(campaign, [](const Case& c) { return c.has_passed(); });
  rows.push_back(row_of(campaign, "all limits", passed, judged));
  if (judged < campaign.cases.size())
    rows.push_back(row_of(campaign, "all limits, if every other case were not to pass", passed, campaign.cases.size()));
}

/// Adds a row for each limit, over the judged cases: one that is not complete has kept no limit.
void add_limits(const Content& content, std::vector<Row>& rows) {
  if (content.campaign.limits.empty()) return;
  rows.push_back({"each limit"});
  const auto judged = count_cases(content.campaign, [](const Case& c) { return c.is_judged(); });
  for (const Quantity& quantity : content.quantities) {
    if (!quantity.has_limit()) continue;
    const auto kept = std::ranges::count_if(
        quantity.values, [&](double value) { return value == value && quantity.badness(value) <= 0.0; });
    rows.push_back(row_of(content.campaign, fmt::format("{} {}", quantity.key, limits_text(quantity)),
                          static_cast<std::size_t>(kept), judged));
  }
}

void add_sweep_points(const Campaign& campaign, std::vector<Row>& rows) {
  const std::vector<SweepPoint> points = sweep_points(campaign);
  if (points.size() < 2) return;
  rows.push_back({points.size() <= kMaxPoints
                      ? "each point of the sweeps"
                      : fmt::format("the first {} of {} points of the sweeps", kMaxPoints, points.size())});
  for (std::size_t k = 0; k < std::min(points.size(), kMaxPoints); ++k) {
    std::size_t passed = 0, judged = 0;
    for (const std::size_t place : points[k].places) {
      passed += campaign.cases[place].has_passed() ? 1 : 0;
      judged += campaign.cases[place].is_judged() ? 1 : 0;
    }
    rows.push_back(row_of(campaign, points[k].name, passed, judged));
  }
}

/// Explanation of the numbers for the reader.
std::string notes(const Campaign& campaign) {
  std::string text =
      "<p class=\"note\">Rates are of the cases flown to an end: complete, failed or over time; the latter two have "
      "not "
      "passed. Void, lost, killed and missing cases are not among them.";
  if (campaign.is_independent) {
    text += fmt::format(
        " Bounds: two-sided, {:g} %, of independent cases (Clopper and Pearson). All cases must pass, and be at least "
        "{} for a rate of 95 %, {} for 99 %, {} for 99.7 %, to show it (one-sided).",
        100.0 * kConfidence, cases_needed(0.95, kConfidence), cases_needed(0.99, kConfidence),
        cases_needed(0.997, kConfidence));
    if (share_seeds(campaign))
      text +=
          " Points of the sweeps share seeds: the bounds of all cases together are approximate, those of each point "
          "are not.";
  } else {
    text += " The cases are not independent draws (stratified sampling), so that the rates have no such bounds.";
  }
  return text + "</p>\n";
}

}  // namespace

report::Section pass_rate_section(const Content& content) {
  const Campaign& campaign = content.campaign;
  std::vector<Row> rows;
  add_all(campaign, rows);
  add_limits(content, rows);
  add_sweep_points(campaign, rows);
  return {"Pass rates",
          notes(campaign) + report::table({{"", false}, {"cases"}, {"passed"}, {"rate"}, {"95 % bounds"}}, rows),
          {"results.csv", "campaign.json"}};
}

}  // namespace vbar::campaign_report
