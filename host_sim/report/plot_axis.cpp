#include "host_sim/report/plot_axis.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace vbar::report {
namespace {

/// Ticks that a padded range has room for, each with a value of its own.
constexpr double kTicksResolved = 64.0;

/// The least distance between ticks of a range: numbers of type double have to resolve it.
double least_resolved(const Range& range) {
  constexpr double kUnits = 1024.0;  // units of the last place
  const double size = std::max(std::abs(range.low), std::abs(range.high));
  return std::max(kUnits * std::numeric_limits<double>::epsilon() * size, std::numeric_limits<double>::min());
}

/// A multiple of `step`, with the digits that distinguish it from the next one.
std::string tick_text(double value, double step) {
  constexpr double kLargestWritten = 1e9;  // in full
  constexpr int kDecimalsMax = 12;
  const int exponent = static_cast<int>(std::floor(std::log10(step) + 1e-9));
  const double size = std::abs(value);
  if (size < kLargestWritten && exponent >= -kDecimalsMax) return fmt::format("{:.{}f}", value, std::max(-exponent, 0));
  const int digits = size > 0.0 ? static_cast<int>(std::floor(std::log10(size) + 1e-9)) - exponent : 0;
  return fmt::format("{:.{}e}", value, std::clamp(digits, 0, std::numeric_limits<double>::digits10));
}

}  // namespace

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
  const double half = std::max(0.5 * (span > 0.0 ? 1.1 * span : 1.0), 0.5 * kTicksResolved * least_resolved(range));
  constexpr double kLargest = 0.25 * std::numeric_limits<double>::max();  // the span of the padded range is finite
  const double centre = std::clamp(range.centre(), -kLargest, kLargest);
  const double half_max = std::min(half, kLargest);
  return {centre - half_max, centre + half_max};
}

std::vector<Tick> linear_ticks(const Range& range, int count) {
  const double raw = range.span() / count;
  if (!(raw >= least_resolved(range))) return {};  // also of ranges that are not finite
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  const double leading = raw / power;
  const double step = power * (leading < 1.5 ? 1.0 : leading < 3.5 ? 2.0 : leading < 7.5 ? 5.0 : 10.0);

  std::vector<Tick> ticks;
  const double first = std::ceil(range.low / step - 1e-9);
  const double last = std::floor(range.high / step + 1e-9);
  const int ticks_max = 2 * count + 2;  // a step is at least two thirds of `raw`
  for (int k = 0; k < ticks_max && first + k <= last; ++k) {
    const double value = (first + k) * step + 0.0;  // + 0.0: no "-0"
    ticks.push_back({value, tick_text(value, step)});
  }
  return ticks;
}

std::vector<Tick> decade_ticks(const Range& range, int count) {
  if (!(range.low > 0.0 && std::isfinite(range.high))) return {};
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
