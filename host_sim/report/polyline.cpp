#include "host_sim/report/polyline.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <set>
#include <utility>

namespace vbar::report {
namespace {

double distance_to_segment(const Point& p, const Point& a, const Point& b) {
  const double dx = b.x - a.x;
  const double dy = b.y - a.y;
  const double squared = dx * dx + dy * dy;
  const double along = squared > 0.0 ? ((p.x - a.x) * dx + (p.y - a.y) * dy) / squared : 0.0;
  const double t = std::clamp(along, 0.0, 1.0);
  return std::hypot(p.x - (a.x + t * dx), p.y - (a.y + t * dy));
}

}  // namespace

std::vector<Point> thinned_curve(const std::vector<Point>& points, double tolerance) {
  if (points.size() < 3) return points;
  std::vector<bool> needed(points.size(), false);
  needed.front() = needed.back() = true;
  // A stack of stretches instead of recursion: a long noisy run would go deep.
  std::vector<std::pair<std::size_t, std::size_t>> stretches{{0, points.size() - 1}};
  while (!stretches.empty()) {
    const auto [first, last] = stretches.back();
    stretches.pop_back();
    std::size_t farthest = first;
    double most = tolerance;
    for (std::size_t k = first + 1; k < last; ++k) {
      const double distance = distance_to_segment(points[k], points[first], points[last]);
      if (distance > most) {
        most = distance;
        farthest = k;
      }
    }
    if (farthest == first) continue;
    needed[farthest] = true;
    stretches.emplace_back(first, farthest);
    stretches.emplace_back(farthest, last);
  }
  std::vector<Point> kept;
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (needed[k]) kept.push_back(points[k]);
  }
  return kept;
}

std::vector<Point> thinned_dots(const std::vector<Point>& points, double distance) {
  std::set<std::pair<std::int64_t, std::int64_t>> taken;
  std::vector<Point> kept;
  for (const Point& p : points) {
    if (taken.emplace(std::llround(p.x / distance), std::llround(p.y / distance)).second) kept.push_back(p);
  }
  return kept;
}

std::vector<Point> stairs(const std::vector<Point>& points) {
  std::vector<Point> corners;
  for (const Point& p : points) {
    if (!corners.empty()) corners.push_back({p.x, corners.back().y});
    corners.push_back(p);
  }
  return corners;
}

}  // namespace vbar::report
