#include <cmath>
#include <limits>
#include <regex>
#include <stdexcept>
#include <string_view>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host_sim/report/plots/number_text.h"
#include "host_sim/report/plots/svg_plot.h"
#include "host_sim/report/run_series.h"
#include "host_sim/report/statistics.h"
#include "tests/support/figures.h"
#include "tests/unit/host_sim/report/synthetic_run.h"

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

// Every point is counted once, in the cell whose centre is nearest: never farther than the corner of a hexagon.
TEST(HexagonalCells, CountEveryPointInTheNearestCell) {
  constexpr double kDistance = 7.0;
  const std::vector<Point> points = wavy_curve();
  std::size_t total = 0;
  for (const Cell& cell : hexagonal_cells(points, kDistance)) total += cell.count;
  EXPECT_EQ(total, points.size());
  for (const Point& p : points) {
    const std::vector<Cell> alone = hexagonal_cells({p}, kDistance);
    ASSERT_EQ(alone.size(), 1U);
    EXPECT_LE(std::hypot(alone[0].centre.x - p.x, alone[0].centre.y - p.y), kDistance / std::sqrt(3.0) + 1e-9);
  }
  EXPECT_EQ(hexagonal_cells({{0.1, 0.1}, {-0.2, 0.0}, {20.0, 0.0}}, kDistance).size(), 2U);
  EXPECT_TRUE(hexagonal_cells({}, kDistance).empty());
}

TEST(Clipped, CutsSegmentsAtTheFrame) {
  const Box box{0.0, 0.0, 10.0, 10.0};
  // In by the left edge, out at the top far above, back in, and out at the lower right corner's side.
  const auto pieces = clipped({{-10.0, 5.0}, {5.0, 5.0}, {5.0, -1e6}, {8.0, -1e6}, {8.0, 5.0}, {28.0, 15.0}}, box);
  ASSERT_EQ(pieces.size(), 2U);
  ASSERT_EQ(pieces[0].size(), 3U);
  EXPECT_EQ(pieces[0][0].x, 0.0);
  EXPECT_EQ(pieces[0][0].y, 5.0);
  EXPECT_EQ(pieces[0][2].x, 5.0);
  EXPECT_EQ(pieces[0][2].y, 0.0);
  ASSERT_EQ(pieces[1].size(), 3U);
  EXPECT_EQ(pieces[1][0].x, 8.0);
  EXPECT_EQ(pieces[1][0].y, 0.0);
  EXPECT_EQ(pieces[1][2].x, 10.0);
  EXPECT_NEAR(pieces[1][2].y, 6.0, 1e-12);
}

// Both ends outside and the middle inside: dropping points would lose it.
TEST(Clipped, KeepsASegmentThatCrossesTheFrame) {
  const auto pieces = clipped({{-10.0, -10.0}, {20.0, 20.0}}, {0.0, 0.0, 10.0, 10.0});
  ASSERT_EQ(pieces.size(), 1U);
  EXPECT_NEAR(pieces[0][0].x, 0.0, 1e-12);
  EXPECT_NEAR(pieces[0][1].y, 10.0, 1e-12);
  EXPECT_TRUE(clipped({{-10.0, 5.0}, {5.0, 20.0}}, {0.0, 0.0, 10.0, 10.0}).empty()) << "past the corner";
  EXPECT_TRUE(clipped({}, {0.0, 0.0, 10.0, 10.0}).empty());
}

TEST(SvgPlot, DrawsNothingOutsideItsFrame) {
  Plot plot;
  plot.x = {.name = "x", .range = Range{0.0, 1.0}};
  plot.y = {.name = "y", .range = Range{-1.0, 1.0}};
  plot.series = {{"spike", 0, Mark::kDashedLine, {{-5.0, 0.0}, {0.4, 0.0}, {0.5, 1e300}, {0.6, 0.0}, {1.0, 1e9}}},
                 {"dots", 1, Mark::kBroadDots, {{0.5, 0.5}, {0.5, 3.0}, {2.0, 0.0}, {0.5, std::nan("")}}}};
  plot.events = {-3.0, 0.5, 7.0};
  plot.rings = {{{0.5, 40.0}, "outside", ""}};
  const std::string text = svg(plot);
  const std::regex number(R"([ML](-?[0-9.e+]+) (-?[0-9.e+]+))");
  int count = 0;
  for (std::sregex_iterator match(text.begin(), text.end(), number), end; match != end; ++match, ++count) {
    EXPECT_GE(std::stod((*match)[1]), 0.0);
    EXPECT_LE(std::stod((*match)[1]), plot.width);
    EXPECT_GE(std::stod((*match)[2]), 0.0);
    EXPECT_LE(std::stod((*match)[2]), plot.height);
  }
  EXPECT_GE(count, 5) << "the line's pieces, a dot and an event";
  EXPECT_EQ(text.find("outside"), std::string::npos);
}

TEST(Legend, NamesWhatIsDrawnOnce) {
  Plot plot;
  plot.y.logarithmic = true;
  plot.series = {{"shown", 0, Mark::kLine, {{0.0, 1.0}}},
                 {"zeros on a logarithmic axis", 1, Mark::kLine, {{0.0, 0.0}}},
                 {"", 2, Mark::kLine, {{0.0, 1.0}}},
                 {"other", 3, Mark::kDots, {{0.0, 1.0}}}};
  const std::string text = legend({plot, plot});
  EXPECT_NE(text.find("shown"), std::string::npos);
  EXPECT_EQ(text.find("shown"), text.rfind("shown"));
  EXPECT_EQ(text.find("zeros"), std::string::npos);
  plot.series.resize(1);
  EXPECT_TRUE(legend({plot}).empty());
  EXPECT_FALSE(legend({plot}, 1).empty());
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

TEST(Ticks, AreFewOnAnyRange) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity(), kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kMax = std::numeric_limits<double>::max(), kMin = std::numeric_limits<double>::denorm_min();
  const double one = 7.962050537420753, next = std::nextafter(one, 8.0);
  for (const Range& range :
       {Range{one, next}, Range{one, one}, Range{0.0, 0.0}, Range{1e300, 1e300}, Range{-kMax, kMax}, Range{0.0, kMax},
        Range{0.0, kMin}, Range{-kMin, kMin}, Range{kMin, 1.0}, Range{one, kInfinity}, Range{-kInfinity, kInfinity},
        Range{kNan, 1.0}, Range{9007199254740991.0, 9007199254740993.0}, Range{1.0, 0.0}}) {
    EXPECT_LE(linear_ticks(range, 6).size(), 14U) << range.low << " to " << range.high;
    EXPECT_LE(decade_ticks(range, 6).size(), 14U) << range.low << " to " << range.high;
    Plot plot;
    plot.series = {{"range", 0, Mark::kLine, {{range.low, range.low}, {range.high, range.high}}}};
    for (const bool logarithmic : {false, true}) {
      plot.x.logarithmic = plot.y.logarithmic = logarithmic;
      EXPECT_LT(svg(plot).size(), 20000U) << range.low << " to " << range.high;
    }
    EXPECT_LT(timeline({{"row", {}}}, range).size(), 20000U);
  }
}

TEST(Ticks, OfAlmostEqualNumbersDiffer) {
  for (const double value : {7.962050537420753, -3.1e-7, 1.0e-300, 4.2e17, 1.0e300}) {
    const Range range = padded({value, std::nextafter(value, 1e308)}, 0.0);
    const std::vector<Tick> ticks = linear_ticks(range, 6);
    ASSERT_GE(ticks.size(), 3U) << value;
    for (std::size_t k = 1; k < ticks.size(); ++k) {
      EXPECT_GT(ticks[k].value, ticks[k - 1].value) << value;
      EXPECT_LT(ticks[k].text.size(), 25U) << value;
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
  EXPECT_EQ(measure_text(3.83, "m/s"), "3.83 m/s");
  EXPECT_EQ(measure_text(0.0057, "m/s"), "5.70 mm/s");
  EXPECT_EQ(measure_text(0.0731, "m"), "73.1 mm");
  EXPECT_EQ(measure_text(123.4, "m"), "123 m");
  EXPECT_EQ(measure_text(74800.0, "m"), "74.8 km");
  EXPECT_EQ(measure_text(1e-9, "m"), "< 0.01 mm");
  EXPECT_EQ(measure_text(0.0, "m"), "0 m");
  EXPECT_EQ(measure_text(std::nan(""), "m"), "–");
}

TEST(NumberText, PercentagesAddUp) {
  using testing::ElementsAre;
  EXPECT_THAT(percentages({1.0, 1.0, 1.0}), ElementsAre(33.3, 33.3, 33.4));
  EXPECT_THAT(percentages({3.0, -1.0, 1.0}), ElementsAre(75.0, 0.0, 25.0));
  EXPECT_THAT(percentages({0.0, 0.0}), ElementsAre(0.0, 0.0));
  EXPECT_THAT(percentages({std::nan(""), 1.0}), ElementsAre(0.0, 100.0));
}

// Quantiles from NIST/SEMATECH e-Handbook of Statistical Methods, 1.3.6.7.4 (critical values of chi-square).
TEST(Consistency, BandsAreThoseOfTables) {
  EXPECT_NEAR(chi_square_band(2.0).low, 0.051, 5e-4);
  EXPECT_NEAR(chi_square_band(2.0).high, 7.378, 5e-4);
  EXPECT_NEAR(chi_square_band(6.0).low, 1.237, 5e-4);
  EXPECT_NEAR(chi_square_band(6.0).high, 14.449, 5e-4);
  EXPECT_NEAR(mean_band(2.0, 50).low, 74.222 / 50.0, 1e-5) << "100 degrees of freedom";
  EXPECT_NEAR(mean_band(2.0, 50).high, 129.561 / 50.0, 1e-5);
}

TEST(Consistency, SetsOffMeansOutsideTheirBand) {
  EXPECT_EQ(consistency_fact("NIS", 2.1, 2.0, 50).value,
            "2.10, 2 expected; inside the 95 % band 1.48 to 2.59 of 50 samples");
  EXPECT_FALSE(consistency_fact("NIS", 2.1, 2.0, 50).is_bad);
  EXPECT_TRUE(consistency_fact("NIS", 0.37, 2.0, 50).is_bad);
  EXPECT_THAT(consistency_fact("NIS", 2.7, 2.0, 50).value, testing::HasSubstr("above"));
  EXPECT_EQ(consistency_fact("NIS", std::nullopt, 2.0, 50).value, "–");
  EXPECT_EQ(consistency_fact("NIS", std::nan(""), 2.0, 50).value, "–");
  EXPECT_EQ(consistency_fact("NIS", 2.1, 2.0, 0).value, "2.10, 2 expected");
}

}  // namespace

namespace {

// The paper calls waypoints 0 to 4 far range, 5 to 7 mid range and 8 to 10 close range.
TEST(MissionViews, SplitThePapersMissionAsThePaperDoes) {
  const std::vector<View> views = mission_views(synthetic_run());
  ASSERT_EQ(views.size(), 3U);
  EXPECT_EQ(views[0].name, "waypoints 0 to 4");
  EXPECT_EQ(views[1].name, "waypoints 4 to 8");
  EXPECT_EQ(views[2].name, "waypoints 8 to 10");
  EXPECT_EQ(views[0].start_s, 0.0);
  EXPECT_EQ(views[1].start_s, views[0].end_s);
  EXPECT_EQ(views[2].start_s, 39.0 * 3600.0);
  EXPECT_EQ(views[2].end_s, 41.25 * 3600.0);
}

TEST(MissionViews, CloseRangeAloneIsOneView) {
  RunRecord record = synthetic_run();
  record.waypoints.erase(record.waypoints.begin(), record.waypoints.begin() + 8);
  const std::vector<View> views = mission_views(record);
  ASSERT_EQ(views.size(), 1U);
  EXPECT_EQ(views.front().waypoints.size(), 3U);
}

TEST(MissionViews, ARunWithoutWaypointsIsSeenWhole) {
  RunRecord record = synthetic_run();
  record.waypoints.clear();
  const std::vector<View> views = mission_views(record);
  ASSERT_EQ(views.size(), 1U);
  EXPECT_EQ(views.front().name, "whole run");
  EXPECT_EQ(views.front().end_s, record.truth.back().time_s);
}

TEST(MissionViews, ARunWithoutAnyStepHasAView) {
  EXPECT_EQ(mission_views({}).size(), 1U);
}

}  // namespace

}  // namespace vbar::report::test
