// The worst cases of each figure, with what they were flown with and the command that flies them again.

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host_sim/campaign_report/case_text.h"
#include "host_sim/campaign_report/sections.h"

namespace vbar::campaign_report {
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
                    fmt::format("<code>{}</code>", report::escaped(rerun_command(content, one)))});
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
