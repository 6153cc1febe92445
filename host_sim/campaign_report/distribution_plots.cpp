#include "host_sim/campaign_report/distribution_plots.h"

#include <algorithm>
#include <cmath>

namespace vbar::campaign_report {
namespace {

using report::Mark;
using report::Plot;
using report::Point;
using report::Range;

constexpr std::size_t kMaxSteps = 500;
constexpr int kMinBins = 8, kMaxBins = 48;

/// The values with room beside them, and the limits unless they are far away.
Range shown_range(const Quantity& quantity, const std::vector<double>& sorted, bool is_logarithmic) {
  constexpr double kFar = 3.0;  // times the span of the values
  if (is_logarithmic) {
    Range range{sorted.front() / 1.3, sorted.back() * 1.3};
    if (quantity.max && *quantity.max > 0.0) range.high = std::max(range.high, *quantity.max * 1.3);
    return range;
  }
  const double span = sorted.back() - sorted.front();
  Range all{sorted.front(), sorted.back()};
  for (const std::optional<double>& limit : {quantity.max, quantity.min}) {
    if (!limit || *limit > sorted.back() + kFar * span || *limit < sorted.front() - kFar * span) continue;
    all = {std::min(all.low, *limit), std::max(all.high, *limit)};
  }
  Range range = report::padded(all, 1e-12 * std::abs(sorted.back()));
  if (sorted.front() >= 0.0 && sorted.front() < 0.3 * all.high) range.low = 0.0;  // sizes, seen from zero
  return range;
}

Plot plot_of(const Quantity& quantity, const std::vector<double>& sorted, const char* title) {
  Plot plot;
  plot.title = quantity.key + title;
  plot.x = axis_of(quantity.key);
  plot.x.logarithmic = is_heavy_tailed(sorted);
  plot.x.range = shown_range(quantity, sorted, plot.x.logarithmic);
  plot.height = 230.0;
  if (quantity.max) plot.moments.push_back({*quantity.max, "at most " + value_text(quantity.key, *quantity.max)});
  if (quantity.min) plot.moments.push_back({*quantity.min, "at least " + value_text(quantity.key, *quantity.min)});
  return plot;
}

}  // namespace

Plot histogram(const Quantity& quantity, const std::vector<double>& sorted) {
  Plot plot = plot_of(quantity, sorted, ", histogram");
  const Range range = *plot.x.range;
  const auto count = static_cast<int>(2.0 * std::cbrt(static_cast<double>(sorted.size())));  // Rice's rule
  const int bins = std::clamp(count, kMinBins, kMaxBins);
  const auto edge = [&](int k) {
    const double share = static_cast<double>(k) / bins;
    return plot.x.logarithmic ? range.low * std::pow(range.high / range.low, share) : range.low + share * range.span();
  };
  std::vector<Point> outline{{edge(0), 0.0}};
  auto from = sorted.begin();
  double largest = 0.0;
  for (int k = 0; k < bins; ++k) {
    const auto end = k + 1 == bins ? sorted.end() : std::lower_bound(from, sorted.end(), edge(k + 1));
    const auto cases = static_cast<double>(end - from);
    outline.push_back({edge(k), cases});
    outline.push_back({edge(k + 1), cases});
    largest = std::max(largest, cases);
    from = end;
  }
  outline.push_back({edge(bins), 0.0});
  plot.y = {.name = "cases", .range = Range{0.0, 1.08 * largest}};
  plot.series = {{"", 0, Mark::kArea, outline}, {"", 0, Mark::kLine, outline}};
  return plot;
}

std::vector<Point> distribution_steps(const std::vector<double>& sorted, std::size_t max_steps) {
  const std::size_t steps = std::min(sorted.size(), max_steps);
  std::vector<Point> points;
  for (std::size_t k = 1; k <= steps; ++k) {
    const std::size_t upto =
        k * sorted.size() / steps;  // the largest value of each group: the last is the largest of all
    points.push_back({sorted[upto - 1], static_cast<double>(upto) / static_cast<double>(sorted.size())});
  }
  return points;
}

Plot distribution_function(const Quantity& quantity, const std::vector<double>& sorted) {
  Plot plot = plot_of(quantity, sorted, ", share of complete cases up to a value");
  std::vector<Point> points{{plot.x.range->low, 0.0}};
  for (const Point& step : distribution_steps(sorted, kMaxSteps)) points.push_back(step);
  points.push_back({plot.x.range->high, 1.0});
  plot.y = {.name = "share of cases", .range = Range{0.0, 1.02}};
  plot.series = {{"", 0, Mark::kStairs, std::move(points)}};
  return plot;
}

}  // namespace vbar::campaign_report
