#include "host_sim/report/consistency.h"

#include <cmath>

#include <boost/math/distributions/chi_squared.hpp>
#include <fmt/format.h>

#include "host_sim/report/number_text.h"

namespace vbar::report {

Range chi_square_band(double degrees) {
  constexpr double kTail = 0.025;
  const boost::math::chi_squared distribution(degrees);
  return {boost::math::quantile(distribution, kTail),
          boost::math::quantile(boost::math::complement(distribution, kTail))};
}

Range mean_band(double degrees, std::size_t samples) {
  const auto count = static_cast<double>(samples);
  const Range sum = chi_square_band(degrees * count);
  return {sum.low / count, sum.high / count};
}

Fact consistency_fact(const std::string& name, const std::optional<double>& mean, double degrees, std::size_t samples) {
  Fact fact{name, fixed(mean, 2)};
  if (!mean || !std::isfinite(*mean)) return fact;
  fact.value += fmt::format(", {:g} expected", degrees);
  if (samples == 0) return fact;
  const Range band = mean_band(degrees, samples);
  fact.is_bad = *mean < band.low || *mean > band.high;
  fact.value += fmt::format("; {} the 95 % band {} to {} of {} samples",
                            !fact.is_bad       ? "inside"
                            : *mean < band.low ? "below"
                                               : "above",
                            fixed(band.low, 2), fixed(band.high, 2), grouped(samples));
  return fact;
}

}  // namespace vbar::report
