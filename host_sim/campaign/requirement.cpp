#include "host_sim/campaign/requirement.h"

#include <fmt/format.h>

#include "host_sim/campaign_report/pass_rate.h"

namespace vbar::campaign {

RequirementVerdict judge(const Requirement& requirement, std::size_t passed, std::size_t cases, bool independent) {
  if (!independent)
    return {false, "requirement not judged: the cases of a Latin hypercube are not an independent sample"};
  const double bound = campaign_report::pass_rate(passed, cases, requirement.confidence).lower;
  const bool met = bound >= requirement.pass_rate;
  return {met, fmt::format("requirement {}: {} of {} cases passed, a pass rate of at least {:.2f} % at {:g} % "
                           "confidence, two-sided; {:g} % required",
                           met ? "met" : "not met", passed, cases, 100.0 * bound, 100.0 * requirement.confidence,
                           100.0 * requirement.pass_rate)};
}

}  // namespace vbar::campaign
