#include "host_sim/report/paper_table.h"

#include <fmt/format.h>

#include "host_sim/report/number_text.h"

namespace vbar::report {

std::string plus_minus(const std::optional<MeanAndDeviation>& value, int decimals, double scale) {
  if (!value) return fixed(std::nullopt, decimals);
  return fmt::format("{} ± {}", fixed(scale * value->mean, decimals), fixed(scale * value->std, decimals));
}

}  // namespace vbar::report
