// Reasons of failure: failures by reason, limits that were broken, cases that show nothing.

#include <algorithm>
#include <cctype>
#include <map>

#include <fmt/format.h>

#include "host_sim/campaign_report/case_text.h"
#include "host_sim/campaign_report/sections.h"
#include "host_sim/report/number_text.h"

namespace vbar::campaign_report {
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
    rows.push_back({group.what, group.example.empty() ? "(not given)" : group.example,
                    report::grouped(group.cases.size()), numbers_of(group),
                    fmt::format("<code>{}</code>", report::escaped(rerun_command(content, *group.cases.front())))});
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

}  // namespace vbar::campaign_report
