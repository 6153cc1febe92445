#include <cmath>
#include <stdexcept>
#include <string_view>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host_sim/report/number_text.h"
#include "host_sim/report/svg_plot.h"
#include "tests/support/figures.h"

namespace vbar::report::test {
namespace {

constexpr double kSearchStep = 0.1;  // pixels

// By search along the segment: slower than the formula, and independent of it.
double distance_to_segment(const Point& p, const Point& a, const Point& b) {
  accuracy::Smallest least(std::hypot(p.x - a.x, p.y - a.y));
  const int steps = 1 + static_cast<int>(std::hypot(b.x - a.x, b.y - a.y) / kSearchStep);
  for (int k = 1; k <= steps; ++k) {
    const double t = static_cast<double>(k) / steps;
    least.add(std::hypot(p.x - a.x - t * (b.x - a.x), p.y - a.y - t * (b.y - a.y)));
  }
  return least;
}

std::vector<Point> wavy_curve() {
  std::vector<Point> points;
  for (int k = 0; k < 1500; ++k) {
    const double x = 0.4 * k;
    points.push_back({x, 100.0 + 60.0 * std::sin(0.02 * x) + 3.0 * std::sin(7.0 * x)});
  }
  return points;
}

TEST(ThinnedCurve, StaysWithinTheTolerance) {
  const std::vector<Point> points = wavy_curve();
  for (const double tolerance : {0.25, 2.0, 10.0}) {
    const std::vector<Point> kept = thinned_curve(points, tolerance);
    ASSERT_GE(kept.size(), 2U);
    EXPECT_LT(kept.size(), points.size());
    EXPECT_EQ(kept.front().x, points.front().x);
    EXPECT_EQ(kept.back().x, points.back().x);
    for (const Point& p : points) {
      accuracy::Smallest least;
      for (std::size_t k = 0; k + 1 < kept.size(); ++k) {
        if (kept[k + 1].x < p.x - 11.0 || kept[k].x > p.x + 11.0) continue;  // farther than any tolerance tried
        least.add(distance_to_segment(p, kept[k], kept[k + 1]));
      }
      // The search may miss the nearest place by half a step.
      ASSERT_LE(least, tolerance + 0.5 * kSearchStep) << p.x;
    }
  }
}

TEST(ThinnedCurve, AStraightLineNeedsItsEndsOnly) {
  std::vector<Point> line;
  for (int k = 0; k < 100; ++k) line.push_back({1.0 * k, 3.0 * k});
  EXPECT_EQ(thinned_curve(line, 1e-6).size(), 2U);
  EXPECT_TRUE(thinned_curve({}, 1.0).empty());
}

// A spike of a single point is what a reader looks for: it must survive.
TEST(ThinnedCurve, KeepsASpike) {
  std::vector<Point> line;
  for (int k = 0; k < 1001; ++k) line.push_back({0.1 * k, k == 500 ? 5.0 : 0.0});
  EXPECT_EQ(thinned_curve(line, 0.25).size(), 5U) << "two ends, the spike and its two feet";
}

TEST(ThinnedDots, DropsOnlyThoseThatLieOnOthers) {
  EXPECT_EQ(thinned_dots({{0.0, 0.0}, {0.1, 0.1}, {5.0, 5.0}, {5.0, 9.0}}, 1.0).size(), 3U);
}

TEST(Ticks, AreRoundInsideAndEvenlySpaced) {
  for (const Range& range : {Range{0.0, 41.25}, Range{-75000.0, 0.0}, Range{-0.013, 0.0171}, Range{1e-9, 3e-9},
                             Range{1e6, 1e6 + 3.0}, Range{-1.0, 1.0}}) {
    const std::vector<Tick> ticks = linear_ticks(range, 6);
    ASSERT_GE(ticks.size(), 3U);
    ASSERT_LE(ticks.size(), 13U);
    const double step = ticks[1].value - ticks[0].value;
    const double leading = step / std::pow(10.0, std::floor(std::log10(step) + 1e-6));
    EXPECT_THAT(leading, testing::AnyOf(testing::DoubleNear(1.0, 1e-6), testing::DoubleNear(2.0, 1e-6),
                                        testing::DoubleNear(5.0, 1e-6)));
    for (const Tick& tick : ticks) {
      EXPECT_GE(tick.value, range.low - 1e-6 * step);
      EXPECT_LE(tick.value, range.high + 1e-6 * step);
      // What is written is what is meant, to well under the distance of two ticks.
      EXPECT_NEAR(std::stod(tick.text), tick.value, 1e-3 * step);
    }
  }
}

TEST(Ticks, DecadesArePowersOfTen) {
  const std::vector<Tick> ticks = decade_ticks({0.02, 30000.0}, 10);
  ASSERT_EQ(ticks.size(), 6U);
  EXPECT_EQ(ticks.front().text, "0.1");
  EXPECT_EQ(ticks.back().text, "10000");
}

TEST(DisplayUnit, SuitsTheSize) {
  EXPECT_EQ(display_unit(Unit::kMetres, 75000.0).symbol, "km");
  EXPECT_EQ(display_unit(Unit::kMetres, 7.0).symbol, "m");
  EXPECT_EQ(display_unit(Unit::kMetres, 0.02).symbol, "mm");
  EXPECT_EQ(display_unit(Unit::kMetresPerSecond, 4.0).symbol, "m/s");
  EXPECT_EQ(display_unit(Unit::kRadians, 4.0).symbol, "deg");
  EXPECT_EQ(display_unit(Unit::kRadiansPerSecond, 4.0).symbol, "deg/s");
  EXPECT_EQ(display_unit(Unit::kMetresPerSecond, 0.006).symbol, "mm/s");
}

/// The number behind `key`, looked for from `at` on, which moves behind it.
double number_behind(const std::string& text, std::string_view key, std::size_t& at) {
  const std::size_t found = text.find(key, at);
  if (found == std::string::npos) throw std::runtime_error("no " + std::string(key));
  std::size_t size = 0;
  const double number = std::stod(text.substr(found + key.size(), 24), &size);
  at = found + key.size() + size;
  return number;
}

// A line from one corner of the axes' ranges to the other must run from corner to corner of the frame.
TEST(SvgPlot, PutsValuesWhereTheAxesSay) {
  for (const bool logarithmic : {false, true}) {
    Plot plot;
    plot.x = {.name = "x", .range = Range{-2.0, 6.0}};
    plot.y = {.name = "y", .unit = Unit::kMetres, .range = Range{3.0, 9000.0}, .logarithmic = logarithmic};
    plot.series = {{"line", 0, Mark::kLine, {{-2.0, 3.0}, {6.0, 9000.0}}}};
    const std::string text = svg(plot);
    std::size_t at = text.find("class=\"frame\"");
    const double left = number_behind(text, "x=\"", at);
    const double top = number_behind(text, "y=\"", at);
    const double right = left + number_behind(text, "width=\"", at);
    const double bottom = top + number_behind(text, "height=\"", at);
    at = text.find("class=\"line c0\"");
    constexpr double kRounding = 0.11;  // pixels are written with one digit, sums of two of them differ by 0.1
    EXPECT_NEAR(number_behind(text, "M", at), left, kRounding);
    EXPECT_NEAR(number_behind(text, " ", at), bottom, kRounding);
    EXPECT_NEAR(number_behind(text, "L", at), right, kRounding);
    EXPECT_NEAR(number_behind(text, " ", at), top, kRounding);
  }
}

// A circle must look like one: as many pixels across as up.
TEST(SvgPlot, SameScaleKeepsShapes) {
  Plot plot;
  plot.x = {.name = "x", .unit = Unit::kMetres};
  plot.y = {.name = "y", .unit = Unit::kMetres};
  plot.same_scale = true;
  plot.rings = {{{-2.0, 0.0}, "", ""}, {{2.0, 0.0}, "", ""}, {{0.0, -2.0}, "", ""}, {{0.0, 2.0}, "", ""}};
  const std::string text = svg(plot);
  std::vector<Point> centres;
  std::size_t at = 0;
  for (std::size_t k = 0; k < plot.rings.size(); ++k) {
    const double x = number_behind(text, "cx=\"", at);
    centres.push_back({x, number_behind(text, "cy=\"", at)});
  }
  EXPECT_NEAR(centres[1].x - centres[0].x, centres[2].y - centres[3].y, 0.21);  // four numbers of one digit
}

TEST(SvgPlot, LogarithmicAxesSkipWhatIsNotPositive) {
  Plot plot;
  plot.y.logarithmic = true;
  plot.series = {{"line", 0, Mark::kLine, {{0.0, 0.0}, {1.0, 1.0}, {2.0, 10.0}, {3.0, -5.0}, {4.0, 100.0}}}};
  const std::string text = svg(plot);
  EXPECT_THAT(text, testing::Not(testing::HasSubstr("nan")));
  EXPECT_THAT(text, testing::Not(testing::HasSubstr("inf")));
}

TEST(SvgPlot, GapsAreNotBridged) {
  Plot plot;
  const double none = std::nan("");
  plot.series = {{"line", 0, Mark::kLine, {{0.0, 0.0}, {1.0, 1.0}, {2.0, none}, {3.0, 0.0}, {4.0, 1.0}}}};
  const std::string text = svg(plot);
  EXPECT_THAT(text, testing::Not(testing::HasSubstr("nan")));
  std::size_t lines = 0;
  for (std::size_t at = text.find("class=\"line"); at != std::string::npos; at = text.find("class=\"line", at + 1))
    ++lines;
  EXPECT_EQ(lines, 2U);
}

TEST(SvgPlot, EmptyAndConstantDataStillGiveAPlot) {
  Plot plot;
  EXPECT_THAT(svg(plot), testing::Not(testing::HasSubstr("nan")));
  plot.series = {{"constant", 0, Mark::kLine, {{1.0, 0.0}, {1.0, 0.0}}}};
  EXPECT_THAT(svg(plot), testing::Not(testing::HasSubstr("nan")));
}

TEST(NumberText, ReadsWell) {
  EXPECT_EQ(grouped(0), "0");
  EXPECT_EQ(grouped(999), "999");
  EXPECT_EQ(grouped(1000), "1,000");
  EXPECT_EQ(grouped(18446744073709551615ULL), "18,446,744,073,709,551,615");
  EXPECT_EQ(grouped_nearest(250000.5), "250,001");
  EXPECT_EQ(grouped_nearest(-1.0), "–");
  EXPECT_EQ(grouped_nearest(std::nan("")), "–");
  EXPECT_EQ(duration_text(148500.0), "41 h 15 min");
  EXPECT_EQ(duration_text(7200.0), "2 h");
  EXPECT_EQ(duration_text(75.0), "1 min 15 s");
  EXPECT_EQ(duration_text(3599.9), "1 h");
  EXPECT_EQ(duration_text(52.36), "52.4 s");
  EXPECT_EQ(fixed(std::nan(""), 3), "–");
  EXPECT_EQ(fixed(std::nullopt, 3), "–");
  EXPECT_EQ(velocity_text(3.83), "3.8300 m/s");
  EXPECT_EQ(velocity_text(0.0057), "5.7000 mm/s");
}

}  // namespace
}  // namespace vbar::report::test
