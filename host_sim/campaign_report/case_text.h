#pragma once
// Cases and shares as text.

#include <cstddef>
#include <string>
#include <vector>

#include "host_sim/campaign_report/campaign.h"
#include "host_sim/campaign_report/pass_rate.h"
#include "host_sim/campaign_report/sections.h"

namespace vbar::campaign_report {

/// "99.13 %", with more digits where it would be written as 100 % without being it.
[[nodiscard]] std::string percent(double share);

/// "83.16 to 100 %"
[[nodiscard]] std::string bounds_text(const PassRate& rate);

/// "1 case", "2,000 cases"
[[nodiscard]] std::string count_text(std::size_t count, const char* singular, const char* plural);

/// The command that flies a case again.
[[nodiscard]] std::string rerun_command(const Content& content, const Case& one);

/// Shortens keys to what distinguishes them: "servicer.mass_kg", "target.mass_kg", "loss_probability".
[[nodiscard]] std::vector<std::string> short_names(const std::vector<std::string>& keys);

/// "servicer.mass_kg = 153.41 kg; ...": swept and dispersed values, shortened.
[[nodiscard]] std::string inputs_text(const Campaign& campaign, const Case& one);

/// The number of cases that `holds` is true of.
template <class Predicate>
[[nodiscard]] std::size_t count_cases(const Campaign& campaign, const Predicate& holds) {
  std::size_t count = 0;
  for (const Case& one : campaign.cases) count += holds(one) ? 1 : 0;
  return count;
}

}  // namespace vbar::campaign_report
