#include "host_sim/report/plots/plot_axis.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

namespace vbar::report {

namespace {

/// Ticks that a padded range has room for, each with a value of its own.
constexpr double kTicksResolved = 64.0;

/// The least distance between ticks of a range: numbers of type double have to resolve it.
double min_resolved(const Range& range) {
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

Range padded(const Range& range, double min_span) {
  const double span = std::max(range.span(), min_span);
  const double half = std::max(0.5 * (span > 0.0 ? 1.1 * span : 1.0), 0.5 * kTicksResolved * min_resolved(range));
  constexpr double kLargest = 0.25 * std::numeric_limits<double>::max();  // the span of the padded range is finite
  const double centre = std::clamp(range.centre(), -kLargest, kLargest);
  const double half_max = std::min(half, kLargest);
  return {centre - half_max, centre + half_max};
}

std::vector<Tick> linear_ticks(const Range& range, int count) {
  const double raw = range.span() / count;
  if (!(raw >= min_resolved(range)) || !std::isfinite(raw)) return {};
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
  if (!(range.low > 0.0 && range.high >= range.low && std::isfinite(range.high))) return {};
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

namespace {

double distance_to_segment(const Point& p, const Point& a, const Point& b) {
  const double dx = b.x - a.x;
  const double dy = b.y - a.y;
  const double squared = dx * dx + dy * dy;
  const double along = squared > 0.0 ? ((p.x - a.x) * dx + (p.y - a.y) * dy) / squared : 0.0;
  const double t = std::clamp(along, 0.0, 1.0);
  return std::hypot(p.x - (a.x + t * dx), p.y - (a.y + t * dy));
}

/// The part of a segment inside the box, as fractions of its length.
struct Part {
  double from = 0.0, to = 1.0;
};

/// Cuts away what lies beyond one edge: `inside` is the distance of the segment's start from that edge, `change` what
/// is added to it on the way to the end.
bool cut(Part& part, double inside, double change) {
  if (change == 0.0) return inside >= 0.0;
  const double crossing = -inside / change;
  if (change > 0.0)
    part.from = std::max(part.from, crossing);
  else
    part.to = std::min(part.to, crossing);
  return part.from <= part.to;
}

std::optional<Part> part_inside(const Point& a, const Point& b, const Box& box) {
  Part part;
  const double dx = b.x - a.x, dy = b.y - a.y;
  const bool is_inside = cut(part, a.x - box.left, dx) && cut(part, box.right - a.x, -dx) &&
                         cut(part, a.y - box.top, dy) && cut(part, box.bottom - a.y, -dy);
  return is_inside ? std::optional(part) : std::nullopt;
}

/// Clamped, as rounding may leave a cut a last bit outside.
Point between(const Point& a, const Point& b, double fraction, const Box& box) {
  return {std::clamp(a.x + fraction * (b.x - a.x), box.left, box.right),
          std::clamp(a.y + fraction * (b.y - a.y), box.top, box.bottom)};
}

}  // namespace

std::vector<std::vector<Point>> clipped(const std::vector<Point>& curve, const Box& box) {
  std::vector<std::vector<Point>> pieces;
  bool is_open = false;  // the last piece ends where the next segment starts
  for (std::size_t k = 0; k + 1 < curve.size(); ++k) {
    const Point &a = curve[k], &b = curve[k + 1];
    const std::optional<Part> part = part_inside(a, b, box);
    if (!part) {
      is_open = false;
      continue;
    }
    if (!is_open || part->from > 0.0) pieces.push_back({between(a, b, part->from, box)});
    pieces.back().push_back(between(a, b, part->to, box));
    is_open = part->to == 1.0;
  }
  if (curve.size() == 1 && box.holds(curve.front())) pieces.push_back(curve);
  return pieces;
}

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

// Two rectangular grids, one shifted by half a cell: the nearest centre of either is the nearest of the hexagonal grid.
std::vector<Cell> hexagonal_cells(const std::vector<Point>& points, double distance) {
  const double height = std::sqrt(3.0) * distance;
  const auto nearest = [&](const Point& p, double shift) {
    return std::pair{std::llround(2.0 * (std::round(p.x / distance - shift) + shift)),
                     std::llround(2.0 * (std::round(p.y / height - shift) + shift))};
  };
  const auto centre_of = [&](const std::pair<std::int64_t, std::int64_t>& place) {
    return Point{0.5 * static_cast<double>(place.first) * distance, 0.5 * static_cast<double>(place.second) * height};
  };
  const auto distance_to = [](const Point& a, const Point& b) { return std::hypot(a.x - b.x, a.y - b.y); };
  std::map<std::pair<std::int64_t, std::int64_t>, std::size_t> counts;
  for (const Point& p : points) {
    const auto even = nearest(p, 0.0), odd = nearest(p, 0.5);
    ++counts[distance_to(p, centre_of(even)) <= distance_to(p, centre_of(odd)) ? even : odd];
  }
  std::vector<Cell> cells;
  for (const auto& [place, count] : counts) cells.push_back({centre_of(place), count});
  return cells;
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
