#include "host_sim/campaign_report/page.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host_sim/campaign_report/campaign.h"
#include "host_sim/files/output_file.h"
#include "host_sim/report/csv_table.h"
#include "host_sim/report/plots/html_page.h"
#include "host_sim/report/plots/number_text.h"

namespace vbar::campaign_report {

std::string percent(double share) {
  if (share == 1.0) return "100 %";
  if (share == 0.0) return "0 %";
  std::string text = fmt::format("{:.2f}", 100.0 * share);
  for (int decimals = 3; text.starts_with("100") && decimals < 12; ++decimals)
    text = fmt::format("{:.{}f}", 100.0 * share, decimals);
  return text + " %";
}

std::string bounds_text(const PassRate& rate) {
  std::string lower = percent(rate.lower);
  lower.resize(lower.size() - 2);
  return lower + " to " + percent(rate.upper);
}

std::string count_text(std::size_t count, const char* singular, const char* plural) {
  return fmt::format("{} {}", report::grouped(count), count == 1 ? singular : plural);
}

std::string name_of_folder(const std::filesystem::path& folder) {
  const std::filesystem::path whole = std::filesystem::absolute(folder).lexically_normal();
  return (whole.has_filename() ? whole.filename() : whole.parent_path().filename()).string();
}

std::string rerun_command(const std::string& folder, const Case& one) {
  // A name that a shell would split or expand is quoted.
  const bool is_plain =
      folder.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+.,/") ==
      std::string::npos;
  std::string quoted = folder;
  if (!is_plain) {
    quoted = "'";
    for (const char c : folder) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
    quoted += "'";
  }
  return fmt::format("vbar campaign rerun {} {}", quoted, one.number);
}

std::vector<std::string> short_names(const std::vector<std::string>& keys) {
  std::vector<std::string> names;
  for (const std::string& key : keys) {
    std::size_t start = key.rfind('.');
    const auto is_shared = [&] {
      const std::string_view ending = std::string_view(key).substr(start);
      return std::ranges::count_if(keys, [&](const std::string& other) { return ("." + other).ends_with(ending); }) > 1;
    };
    while (start != std::string::npos && start > 0 && is_shared()) start = key.rfind('.', start - 1);
    names.push_back(start == std::string::npos ? key : key.substr(start + 1));
  }
  return names;
}

std::string inputs_text(const Campaign& campaign, const Case& one) {
  const std::vector<std::string> names = short_names(campaign.keys);
  std::string text;
  for (std::size_t k = 0; k < campaign.keys.size(); ++k) {
    double number = 0.0;
    const std::string& input = one.inputs[k];
    const bool is_number = !input.empty() && report::read_value(input, number);
    text += fmt::format("{}{} = {}", text.empty() ? "" : "; ", names[k],
                        is_number ? value_text(campaign.keys[k], number) : input);
  }
  return text;
}

namespace {

using report::Mark;
using report::Plot;
using report::Point;
using report::Range;

constexpr std::size_t kMaxSteps = 500;
constexpr int kMinBins = 8, kMaxBins = 48;

/// The values with room beside them, and the limits unless they are far away.
Range shown_range(const Quantity& quantity, const std::vector<double>& sorted, bool is_logarithmic) {
  constexpr double kFar = 3.0;  // times the span of the values
  if (is_logarithmic) {
    Range range{sorted.front() / 1.3, sorted.back() * 1.3};
    if (quantity.max && *quantity.max > 0.0) range.high = std::max(range.high, *quantity.max * 1.3);
    return range;
  }
  const double span = sorted.back() - sorted.front();
  Range all{sorted.front(), sorted.back()};
  for (const std::optional<double>& limit : {quantity.max, quantity.min}) {
    if (!limit || *limit > sorted.back() + kFar * span || *limit < sorted.front() - kFar * span) continue;
    all = {std::min(all.low, *limit), std::max(all.high, *limit)};
  }
  Range range = report::padded(all, 1e-12 * std::abs(sorted.back()));
  if (sorted.front() >= 0.0 && sorted.front() < 0.3 * all.high) range.low = 0.0;  // sizes, seen from zero
  return range;
}

Plot plot_of(const Quantity& quantity, const std::vector<double>& sorted, const char* title) {
  Plot plot;
  plot.title = quantity.key + title;
  plot.x = axis_of(quantity.key);
  plot.x.logarithmic = is_heavy_tailed(sorted);
  plot.x.range = shown_range(quantity, sorted, plot.x.logarithmic);
  plot.height = 230.0;
  if (quantity.max) plot.moments.push_back({*quantity.max, "at most " + value_text(quantity.key, *quantity.max)});
  if (quantity.min) plot.moments.push_back({*quantity.min, "at least " + value_text(quantity.key, *quantity.min)});
  return plot;
}

}  // namespace

Plot histogram(const Quantity& quantity, const std::vector<double>& sorted) {
  Plot plot = plot_of(quantity, sorted, ", histogram");
  const Range range = *plot.x.range;
  const auto count = static_cast<int>(2.0 * std::cbrt(static_cast<double>(sorted.size())));  // Rice's rule
  const int bins = std::clamp(count, kMinBins, kMaxBins);
  const auto edge = [&](int k) {
    const double share = static_cast<double>(k) / bins;
    return plot.x.logarithmic ? range.low * std::pow(range.high / range.low, share) : range.low + share * range.span();
  };
  std::vector<Point> outline{{edge(0), 0.0}};
  auto from = sorted.begin();
  double largest = 0.0;
  for (int k = 0; k < bins; ++k) {
    const auto end = k + 1 == bins ? sorted.end() : std::lower_bound(from, sorted.end(), edge(k + 1));
    const auto cases = static_cast<double>(end - from);
    outline.push_back({edge(k), cases});
    outline.push_back({edge(k + 1), cases});
    largest = std::max(largest, cases);
    from = end;
  }
  outline.push_back({edge(bins), 0.0});
  plot.y = {.name = "cases", .range = Range{0.0, 1.08 * largest}};
  plot.series = {{"", 0, Mark::kArea, outline}, {"", 0, Mark::kLine, outline}};
  return plot;
}

std::vector<Point> distribution_steps(const std::vector<double>& sorted, std::size_t max_steps) {
  const std::size_t steps = std::min(sorted.size(), max_steps);
  std::vector<Point> points;
  for (std::size_t k = 1; k <= steps; ++k) {
    const std::size_t upto =
        k * sorted.size() / steps;  // the largest value of each group: the last is the largest of all
    points.push_back({sorted[upto - 1], static_cast<double>(upto) / static_cast<double>(sorted.size())});
  }
  return points;
}

Plot distribution_function(const Quantity& quantity, const std::vector<double>& sorted) {
  Plot plot = plot_of(quantity, sorted, ", share of complete cases up to a value");
  std::vector<Point> points{{plot.x.range->low, 0.0}};
  for (const Point& step : distribution_steps(sorted, kMaxSteps)) points.push_back(step);
  points.push_back({plot.x.range->high, 1.0});
  plot.y = {.name = "share of cases", .range = Range{0.0, 1.02}};
  plot.series = {{"", 0, Mark::kStairs, std::move(points)}};
  return plot;
}

std::string page_of(const Campaign& campaign, const std::string& folder_name,
                    const std::vector<JudgedRequirement>& requirements, const std::vector<Flight>& flights) {
  const Content content{campaign, quantities(campaign), folder_name, requirements, flights};
  std::vector<report::Section> sections;
  for (auto* const section :
       {requirement_section, pass_rate_section, flight_section, distribution_section, miss_section, consistency_section,
        driver_section, worst_section, failure_section, processor_section})
    sections.push_back(section(content));
  std::string body = overview(content) + report::contents(sections);
  for (const report::Section& section : sections) body += report::section_html(section);
  return report::html_page(campaign.name, body);
}

}  // namespace vbar::campaign_report

namespace vbar::campaign {

WrittenPage write_page(const std::filesystem::path& folder) {
  const campaign_report::Campaign campaign = campaign_report::read_campaign(folder);
  const std::string name = campaign_report::name_of_folder(folder);
  WrittenPage written{folder / "campaign.html", campaign_report::judge_requirements(campaign, name)};
  files::replace_text_file(written.page, campaign_report::page_of(campaign, name, written.requirements,
                                                                  campaign_report::kept_flights(folder, campaign)));
  files::replace_text_file(folder / "campaign_results.json",
                           campaign_report::results_json(campaign, written.requirements));
  return written;
}

}  // namespace vbar::campaign
