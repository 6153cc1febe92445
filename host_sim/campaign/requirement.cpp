#include "host_sim/campaign/requirement.h"

#include <boost/math/distributions/binomial.hpp>
#include <fmt/format.h>

namespace vbar::campaign {

double lower_bound(std::size_t passed, std::size_t cases, double confidence) {
  if (passed == 0 || cases == 0) return 0.0;
  return boost::math::binomial_distribution<>::find_lower_bound_on_p(
      static_cast<double>(cases), static_cast<double>(passed), 0.5 * (1.0 - confidence));
}

RequirementVerdict judge(const Requirement& requirement, std::size_t passed, std::size_t cases, bool independent) {
  if (!independent)
    return {false, "requirement not judged: the cases of a Latin hypercube are not an independent sample"};
  const double bound = lower_bound(passed, cases, requirement.confidence);
  const bool met = bound >= requirement.pass_rate;
  return {met, fmt::format("requirement {}: {} of {} cases passed, a pass rate of at least {:.2f} % at {:g} % "
                           "confidence, two-sided; {:g} % required",
                           met ? "met" : "not met", passed, cases, 100.0 * bound, 100.0 * requirement.confidence,
                           100.0 * requirement.pass_rate)};
}

}  // namespace vbar::campaign
