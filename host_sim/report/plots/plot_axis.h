#pragma once
// An axis of a plot: what range it shows, where its ticks stand and how they are written.

#include <cstddef>
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

/// `range` with room at both ends, and no narrower than `min_span` (so that rounding errors about a constant are not
/// blown up to fill the plot).
[[nodiscard]] Range padded(const Range& range, double min_span);

struct Tick {
  double value = 0.0;
  std::string text;
};

/// Returns about `count` ticks at round numbers (1, 2 or 5 times a power of ten) inside the range.
[[nodiscard]] std::vector<Tick> linear_ticks(const Range& range, int count);

/// Ticks at powers of ten inside a range of positive numbers.
[[nodiscard]] std::vector<Tick> decade_ticks(const Range& range, int count);

// Curves thinned to what an eye can see, so that a report of a long run stays small.

struct Point {
  double x = 0.0, y = 0.0;
};

/// The points that a curve needs to stay within `tolerance` of where it was; ends are kept (Douglas and Peucker, 1973).
[[nodiscard]] std::vector<Point> thinned_curve(const std::vector<Point>& points, double tolerance);

/// Dots without those that would lie within `distance` of one already there, judged on a grid of that size.
[[nodiscard]] std::vector<Point> thinned_dots(const std::vector<Point>& points, double distance);

/// A cell of a hexagonal grid with the number of points in it.
struct Cell {
  Point centre;
  std::size_t count = 0;
};

/// The cells that hold points, of a grid whose centres are `distance` apart (Carr et al., 1987).
[[nodiscard]] std::vector<Cell> hexagonal_cells(const std::vector<Point>& points, double distance);

/// A frame in the coordinates of the points.
struct Box {
  double left = 0.0, top = 0.0, right = 0.0, bottom = 0.0;

  [[nodiscard]] bool holds(const Point& p) const { return p.x >= left && p.x <= right && p.y >= top && p.y <= bottom; }
};

/// The pieces of a curve inside the box; segments are cut where they cross its edges (Liang and Barsky, 1984).
[[nodiscard]] std::vector<std::vector<Point>> clipped(const std::vector<Point>& curve, const Box& box);

/// The corners of a curve that keeps each value until the next point.
[[nodiscard]] std::vector<Point> stairs(const std::vector<Point>& points);

}  // namespace vbar::report
