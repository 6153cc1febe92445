#pragma once
// An axis of a plot: what range it shows, where its ticks stand and how they are written.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace vbar::report {

/// Quantity of the numbers of an axis, in SI; hours for time, arcseconds for small angles.
enum class Unit { kNone, kHours, kMetres, kMetresPerSecond, kRadians, kRadiansPerSecond, kSigmas, kArcseconds };

/// The form in which numbers of that size are best read: 75000 m as 75 km, 0.004 m/s as 4 mm/s, angles in degrees.
struct DisplayUnit {
  double per_si = 1.0;      ///< displayed number = per_si * SI number
  std::string_view symbol;  ///< "" for plain numbers
};
[[nodiscard]] DisplayUnit display_unit(Unit unit, double largest);

struct Range {
  double low = 0.0, high = 0.0;

  [[nodiscard]] double span() const { return high - low; }
  [[nodiscard]] double centre() const { return 0.5 * (low + high); }
};

/// The least range that holds all finite values; none if there are none.
[[nodiscard]] std::optional<Range> range_of(const std::vector<double>& values);

/// `range` with room at both ends, and no narrower than `least_span` (so that rounding errors about a constant are not
/// blown up to fill the plot).
[[nodiscard]] Range padded(const Range& range, double least_span);

struct Tick {
  double value = 0.0;
  std::string text;
};

/// Returns about `count` ticks at round numbers (1, 2 or 5 times a power of ten) inside the range.
[[nodiscard]] std::vector<Tick> linear_ticks(const Range& range, int count);

/// Ticks at powers of ten inside a range of positive numbers.
[[nodiscard]] std::vector<Tick> decade_ticks(const Range& range, int count);

}  // namespace vbar::report
