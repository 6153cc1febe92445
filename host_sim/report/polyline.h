#pragma once
// Curves thinned to what an eye can see, so that a report of a long run stays small.

#include <cstddef>
#include <vector>

namespace vbar::report {

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
