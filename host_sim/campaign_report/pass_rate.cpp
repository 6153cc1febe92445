#include "host_sim/campaign_report/pass_rate.h"

#include <cmath>
#include <stdexcept>
#include <string>

#include <boost/math/distributions/binomial.hpp>

namespace vbar::campaign_report {
namespace {

using Binomial = boost::math::binomial_distribution<double>;

void require_probability(double p, const char* name) {
  if (!(p > 0.0 && p < 1.0)) throw std::invalid_argument(std::string(name) + " is not between 0 and 1");
}

}  // namespace

PassRate pass_rate(std::size_t passed, std::size_t of, double confidence) {
  const double tail = 0.5 * (1.0 - confidence);
  PassRate rate{passed, of, one_sided_lower_bound(passed, of, 1.0 - tail), 1.0};
  if (passed < of) {
    rate.upper = Binomial::find_upper_bound_on_p(static_cast<double>(of), static_cast<double>(passed), tail,
                                                 Binomial::clopper_pearson_exact_interval);
  }
  return rate;
}

double one_sided_lower_bound(std::size_t passed, std::size_t of, double confidence) {
  require_probability(confidence, "confidence");
  if (passed > of) throw std::invalid_argument("more cases have passed than there are");
  if (passed == 0) return 0.0;
  return Binomial::find_lower_bound_on_p(static_cast<double>(of), static_cast<double>(passed), 1.0 - confidence,
                                         Binomial::clopper_pearson_exact_interval);
}

// n cases of probability `rate` all pass with a probability of rate^n, which must not exceed 1 - confidence.
std::size_t cases_needed(double rate, double confidence) {
  require_probability(rate, "pass rate");
  require_probability(confidence, "confidence");
  return static_cast<std::size_t>(std::ceil(std::log1p(-confidence) / std::log(rate) - 1e-9));
}

}  // namespace vbar::campaign_report
