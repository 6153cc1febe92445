// Pass rates with bounds: all cases, each limit, each point of the sweeps.

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "host_sim/campaign_report/page.h"
#include "host_sim/campaign_report/quantity.h"
#include "host_sim/report/csv_table.h"
#include "host_sim/report/plots/number_text.h"

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

report::Section requirement_section(const Content& content) {
  std::vector<Row> rows;
  for (const JudgedRequirement& judged : content.requirements) {
    const Requirement& requirement = judged.requirement;
    const auto text = [&](const std::optional<double>& value) { return value ? value_of(requirement, *value) : "–"; };
    rows.push_back(
        {subject_of(requirement),
         fmt::format("<span class=\"{}\">{}</span>", judged.met ? "" : "bad", judged.met ? "met" : "not met"),
         text(judged.value), text(judged.bound), limit_of(requirement), report::grouped(judged.cases),
         report::grouped(judged.missing.size()),
         judged.worst ? fmt::format("{} (seed {})", judged.worst->number, judged.worst->seed) : "–",
         judged.worst ? fmt::format("<code>{}</code>", report::escaped(judged.worst->command)) : "–",
         requirement.paper});
  }
  if (rows.empty()) return {};
  return {"Requirements",
          "<p class=\"note\">Bounds are two-sided, of the stated confidence: Clopper and Pearson of shares, order "
          "statistics of percentiles. A case without a value is of another state, or its flight gave none.</p>\n" +
              report::table({{"", false},
                             {"", false, true},
                             {"value"},
                             {"bound"},
                             {"required"},
                             {"cases"},
                             {"without a value"},
                             {"worst case"},
                             {"flown again by", false, true},
                             {"published", false}},
                            rows),
          {"results.csv", "campaign.json"}};
}

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

// Reasons of failure: failures by reason, limits that were broken, cases that show nothing.

namespace {

constexpr std::size_t kMaxNamed = 8;    // cases of a row
constexpr std::size_t kMaxGroups = 40;  // rows

/// Reasons that differ in their numbers only are one reason.
std::string without_numbers(const std::string& reason) {
  std::string plain;
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  for (std::size_t k = 0; k < reason.size(); ++k) {
    const bool is_inside =
        k > 0 && k + 1 < reason.size() && reason[k] == '.' && is_digit(reason[k - 1]) && is_digit(reason[k + 1]);
    if (is_digit(reason[k]) || is_inside) {
      if (plain.empty() || plain.back() != '#') plain += '#';
    } else {
      plain += reason[k];
    }
  }
  return plain;
}

struct Group {
  std::string what, example;
  std::vector<const Case*> cases;
};

/// Cases of one state or with one broken limit, by text; the most frequent first.
template <class Includes, class Text>
std::vector<Group> grouped_cases(const Campaign& campaign, const Includes& includes, const Text& text) {
  std::map<std::pair<State, std::string>, Group> groups;
  for (const Case& one : campaign.cases) {
    if (!includes(one)) continue;
    Group& group = groups[{one.state, without_numbers(text(one))}];
    if (group.cases.empty()) group = {std::string(name_of(one.state)), text(one), {}};
    group.cases.push_back(&one);
  }
  std::vector<Group> sorted;
  for (auto& [key, group] : groups) sorted.push_back(std::move(group));
  std::ranges::stable_sort(sorted, std::greater{}, [](const Group& group) { return group.cases.size(); });
  return sorted;
}

std::string numbers_of(const Group& group) {
  std::string text;
  for (std::size_t k = 0; k < std::min(group.cases.size(), kMaxNamed); ++k)
    text += fmt::format("{}{}", text.empty() ? "" : ", ", group.cases[k]->number);
  return group.cases.size() > kMaxNamed ? text + ", …" : text;
}

std::string group_table(const Content& content, const char* heading, const char* reason,
                        const std::vector<Group>& groups) {
  if (groups.empty()) return {};
  std::vector<std::vector<std::string>> rows;
  for (const Group& group : groups) {
    if (rows.size() == kMaxGroups) break;
    rows.push_back(
        {group.what, group.example.empty() ? "(not given)" : group.example, report::grouped(group.cases.size()),
         numbers_of(group),
         fmt::format("<code>{}</code>", report::escaped(rerun_command(content.folder_name, *group.cases.front())))});
  }
  std::string out = fmt::format("<h3>{}</h3>\n", heading);
  if (groups.size() > kMaxGroups) out += fmt::format("<p>The first {} of {}.</p>\n", kMaxGroups, groups.size());
  return out + report::table({{"state", false},
                              {reason, false},
                              {"cases"},
                              {"their numbers", false},
                              {"the first is flown again by", false, true}},
                             rows);
}

}  // namespace

report::Section failure_section(const Content& content) {
  const auto reason = [](const Case& one) { return one.reason; };
  const auto limits = [](const Case& one) { return one.failed_limits; };
  const auto has_failed = [](const Case& one) { return one.state == State::kFailed || one.state == State::kOverTime; };
  const auto breaks_limit = [](const Case& one) { return one.is_complete() && !one.has_passed(); };
  const auto shows_nothing = [](const Case& one) {
    return one.state == State::kVoid || one.state == State::kLost || one.state == State::kKilled;
  };
  const std::string body =
      group_table(content, "Failed", "reason of the first", grouped_cases(content.campaign, has_failed, reason)) +
      group_table(content, "Complete, but beyond limits", "limits",
                  grouped_cases(content.campaign, breaks_limit, limits)) +
      group_table(content, "Without a result", "reason of the first",
                  grouped_cases(content.campaign, shows_nothing, reason));
  if (body.empty()) return {};
  return {"Failures",
          "<p class=\"note\">Reasons that differ only in their numbers are counted together.</p>\n" + body,
          {"results.csv"}};
}

// The worst cases of each figure, with what they were flown with and the command that flies them again.

namespace {

constexpr std::size_t kWorst = 10;
constexpr int kKeptColumn = 5;

/// A link if the case's folder is kept: inside the campaign's own, by a plain name.
std::string folder_link(const std::string& folder) {
  const bool is_plain = !folder.empty() && folder.front() != '/' && folder.find("..") == std::string::npos &&
                        folder.find_first_not_of(
                            "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./") == std::string::npos;
  if (!is_plain) return report::escaped(folder);
  return fmt::format("<a href=\"{0}/\">{0}</a>", folder);
}

/// Places of the cases with a value, the worst first; equal ones by number.
std::vector<std::size_t> worst_places(const Quantity& quantity) {
  std::vector<std::size_t> places;
  for (std::size_t k = 0; k < quantity.values.size(); ++k)
    if (std::isfinite(quantity.values[k])) places.push_back(k);
  std::ranges::stable_sort(places, std::greater{}, [&](std::size_t k) { return quantity.badness(quantity.values[k]); });
  places.resize(std::min(places.size(), kWorst));
  return places;
}

std::string worst_of(const Content& content, const Quantity& quantity) {
  std::vector<std::vector<std::string>> rows;
  for (const std::size_t place : worst_places(quantity)) {
    const Case& one = content.campaign.cases[place];
    const double value = quantity.values[place];
    const bool is_beyond = quantity.has_limit() && quantity.badness(value) > 0.0;
    rows.push_back({std::to_string(one.number),
                    fmt::format("{}{}</span>", is_beyond ? "<span class=\"bad\">" : "<span>",
                                report::escaped(value_text(quantity.key, value))),
                    one.passed.value_or(false) ? "passed" : "not passed", one.seed, inputs_text(content.campaign, one),
                    folder_link(one.folder),
                    fmt::format("<code>{}</code>", report::escaped(rerun_command(content.folder_name, one)))});
  }
  std::vector<report::Column> columns{{"case"},
                                      {"value", true, true},
                                      {"", false},
                                      {"seed"},
                                      {"flown with", false},
                                      {"kept in", false, true},
                                      {"flown again by", false, true}};
  if (std::ranges::all_of(content.campaign.cases, [](const Case& one) { return one.folder.empty(); })) {
    columns.erase(columns.begin() + kKeptColumn);
    for (std::vector<std::string>& row : rows) row.erase(row.begin() + kKeptColumn);
  }
  const std::string limits = limits_text(quantity);
  return fmt::format("<h3>{}{}{}</h3>\n", report::escaped(quantity.key), limits.empty() ? "" : ", ", limits) +
         report::table(columns, rows);
}

}  // namespace

report::Section worst_section(const Content& content) {
  std::string body;
  for (const Quantity& quantity : content.quantities) body += worst_of(content, quantity);
  if (body.empty()) return {};
  return {"Worst cases",
          fmt::format("<p class=\"note\">The commands are for the folder that contains {}.</p>\n",
                      report::escaped(content.folder_name)) +
              body,
          {"results.csv"}};
}

}  // namespace vbar::campaign_report
