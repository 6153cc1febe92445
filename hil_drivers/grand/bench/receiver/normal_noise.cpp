#include "hil_drivers/grand/bench/receiver/normal_noise.h"

#include <cmath>
#include <numbers>

namespace vbar::grand::bench {

const NormalTable& NormalTable::instance() {
  static const NormalTable table;
  return table;
}

// Cubic Hermite: value and derivative (the inverse of the density) of the quantile at both ends of each cell.
NormalTable::NormalTable() {
  constexpr double kWidth = 1.0 / static_cast<double>(kCells);
  const auto value = [](std::size_t node) { return engine::normal_quantile(static_cast<double>(node) * kWidth); };
  const auto derivative = [&value](std::size_t node) {
    const double x = value(node);
    return kWidth * std::sqrt(2.0 * std::numbers::pi) * std::exp(x * x / 2.0);
  };
  for (std::size_t k = kTail; k < kCells - kTail; ++k) {
    const double low = value(k);
    const double high = value(k + 1);
    const double at_low = derivative(k);
    const double at_high = derivative(k + 1);
    cells_[k] = {low, at_low, 3.0 * (high - low) - 2.0 * at_low - at_high, 2.0 * (low - high) + at_low + at_high};
  }
}

}  // namespace vbar::grand::bench
