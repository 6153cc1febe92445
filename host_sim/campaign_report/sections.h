#pragma once
// The parts of the page, in its order. A section without anything to show has no content.

#include <string>
#include <vector>

#include "host_sim/campaign_report/quantity.h"
#include "host_sim/report/html_page.h"

namespace vbar::campaign_report {

/// Confidence of all bounds on the page.
inline constexpr double kConfidence = 0.95;

/// Content from which the sections are made.
struct Content {
  const Campaign& campaign;
  std::vector<Quantity> quantities;
  std::string folder_name;  ///< folder of the campaign
};

[[nodiscard]] std::string overview(const Content& content);  ///< as HTML
[[nodiscard]] report::Section pass_rate_section(const Content& content);
[[nodiscard]] report::Section distribution_section(const Content& content);
[[nodiscard]] report::Section miss_section(const Content& content);
[[nodiscard]] report::Section consistency_section(const Content& content);
[[nodiscard]] report::Section driver_section(const Content& content);
[[nodiscard]] report::Section worst_section(const Content& content);
[[nodiscard]] report::Section failure_section(const Content& content);
[[nodiscard]] report::Section processor_section(const Content& content);

}  // namespace vbar::campaign_report
