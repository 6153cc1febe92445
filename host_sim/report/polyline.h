#pragma once
// Curves thinned to what an eye can see, so that a report of a long run stays small.

#include <vector>

namespace vbar::report {

struct Point {
  double x = 0.0, y = 0.0;
};

/// The points that a curve needs to stay within `tolerance` of where it was; ends are kept (Douglas and Peucker, 1973).
[[nodiscard]] std::vector<Point> thinned_curve(const std::vector<Point>& points, double tolerance);

/// Dots without those that would lie within `distance` of one already there, judged on a grid of that size.
[[nodiscard]] std::vector<Point> thinned_dots(const std::vector<Point>& points, double distance);

/// The corners of a curve that keeps each value until the next point.
[[nodiscard]] std::vector<Point> stairs(const std::vector<Point>& points);

}  // namespace vbar::report
