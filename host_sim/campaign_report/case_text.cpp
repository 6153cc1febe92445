#include "host_sim/campaign_report/case_text.h"

#include <algorithm>

#include <fmt/format.h>

#include "host_sim/report/csv_table.h"
#include "host_sim/report/number_text.h"

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

std::string rerun_command(const Content& content, const Case& one) {
  // A name that a shell would split or expand is quoted.
  const std::string& name = content.folder_name;
  const bool is_plain = name.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+.,") ==
                        std::string::npos;
  std::string quoted = name;
  if (!is_plain) {
    quoted = "'";
    for (const char c : name) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
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

}  // namespace vbar::campaign_report
