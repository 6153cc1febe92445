#include "host_sim/report/plot_axis.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace vbar::report {

DisplayUnit display_unit(Unit unit, double largest) {
  switch (unit) {
    case Unit::kHours:
      return {1.0, "h"};
    case Unit::kSigmas:
      return {1.0, "σ"};
    case Unit::kMetres:
      if (largest >= 3000.0) return {1e-3, "km"};
      return largest < 0.3 ? DisplayUnit{1e3, "mm"} : DisplayUnit{1.0, "m"};
    case Unit::kMetresPerSecond:
      return largest < 0.3 ? DisplayUnit{1e3, "mm/s"} : DisplayUnit{1.0, "m/s"};
    case Unit::kRadians:
      return {180.0 / M_PI, "deg"};
    case Unit::kRadiansPerSecond:
      return {180.0 / M_PI, "deg/s"};
    case Unit::kArcseconds:
      return {1.0, "arcsec"};
    case Unit::kNone:
      break;
  }
  if (largest >= 2e6) return {1e-6, "million"};
  if (largest >= 2e4) return {1e-3, "thousand"};
  return {1.0, ""};
}

std::optional<Range> range_of(const std::vector<double>& values) {
  std::optional<Range> range;
  for (const double v : values) {
    if (!std::isfinite(v)) continue;
    if (!range) range = {v, v};
    range->low = std::min(range->low, v);
    range->high = std::max(range->high, v);
  }
  return range;
}

Range padded(const Range& range, double least_span) {
  const double span = std::max(range.span(), least_span);
  const double half = 0.5 * (span > 0.0 ? 1.1 * span : 1.0);
  return {range.centre() - half, range.centre() + half};
}

std::vector<Tick> linear_ticks(const Range& range, int count) {
  const double raw = range.span() / count;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  const double leading = raw / power;
  const double step = power * (leading < 1.5 ? 1.0 : leading < 3.5 ? 2.0 : leading < 7.5 ? 5.0 : 10.0);
  const int decimals = std::clamp(static_cast<int>(-std::floor(std::log10(step) + 1e-9)), 0, 12);

  std::vector<Tick> ticks;
  const double first = std::ceil(range.low / step - 1e-9);
  const double last = std::floor(range.high / step + 1e-9);
  for (double k = first; k <= last; k += 1.0) {
    const double value = k * step + 0.0;  // + 0.0: no "-0"
    ticks.push_back({value, fmt::format("{:.{}f}", value, decimals)});
  }
  return ticks;
}

std::vector<Tick> decade_ticks(const Range& range, int count) {
  const int first = static_cast<int>(std::ceil(std::log10(range.low) - 1e-9));
  const int last = static_cast<int>(std::floor(std::log10(range.high) + 1e-9));
  const int stride = std::max(1, (last - first + count) / count);
  std::vector<Tick> ticks;
  for (int k = first; k <= last; k += stride) {
    const double value = std::pow(10.0, k);
    ticks.push_back({value, fmt::format("{:g}", value)});
  }
  return ticks;
}

}  // namespace vbar::report
