// Figures of the self check: correction of the day, centroids, verdict. The check of a whole bench is in
// tests/integration/optical_stimulator.

#include "hil_drivers/optical_stimulator/self_check/self_check.h"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil_drivers/optical_stimulator/self_check/day_correction.h"
#include "hil_drivers/optical_stimulator/self_check/windowed_centroid.h"

namespace vbar::optical_stimulator {
namespace {

using fsw::Vector2;
using testing::HasSubstr;

const Vector2 kMiddle(959.5, 599.5);

std::vector<DotPair> moved_dots(const Vector2& shift, double rotation, double scale) {
  std::vector<DotPair> dots;
  for (int k = 0; k < 40; ++k) {
    const Vector2 by_map(100.0 + 43.0 * k, 80.0 + std::fmod(377.0 * k, 1000.0));
    const Vector2 a = by_map - kMiddle;
    const Vector2 turned(std::cos(rotation) * a.x() - std::sin(rotation) * a.y(),
                         std::sin(rotation) * a.x() + std::cos(rotation) * a.y());
    dots.push_back({by_map, kMiddle + scale * turned + shift});
  }
  return dots;
}

TEST(DayCorrection, IsThatOfTheDots) {
  const FittedDay day = fit_day(moved_dots({0.3, -0.7}, 2e-4, 1.00015), kMiddle);
  EXPECT_NEAR(day.correction.shift_px.x(), 0.3, 1e-10);
  EXPECT_NEAR(day.correction.shift_px.y(), -0.7, 1e-10);
  EXPECT_NEAR(day.correction.rotation_rad, 2e-4, 1e-12);
  EXPECT_NEAR(day.correction.scale, 1.00015, 1e-12);
  for (const double residual : day.residuals_px) EXPECT_LT(residual, 1e-9);
}

TEST(DayCorrection, NeedsTwoPlaces) {
  EXPECT_THROW(static_cast<void>(fit_day({}, kMiddle)), std::invalid_argument);
  const std::vector<DotPair> same(3, DotPair{{1.0, 2.0}, {1.0, 2.0}});
  EXPECT_THROW(static_cast<void>(fit_day(same, kMiddle)), std::invalid_argument);
}

std::vector<std::uint16_t> spot_at(const Vector2& at, double sigma) {
  std::vector<std::uint16_t> dn;
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 60; ++x)
      dn.push_back(static_cast<std::uint16_t>(
          std::lround(64.0 + 2000.0 * std::exp(-0.5 * (Vector2(x, y) - at).squaredNorm() / (sigma * sigma)))));
  return dn;
}

TEST(WindowedCentroid, FindsTheMiddleOfASpot) {
  for (const double fraction : {0.0, 0.21, 0.5, 0.83}) {
    const Vector2 at(30.0 + fraction, 20.0 - 0.6 * fraction);
    const auto spot = windowed_centroid(spot_at(at, 1.0), 60, {31.5, 18.5}, 64.0, 1.2, 100.0);
    ASSERT_TRUE(spot.has_value());
    // Rounding to whole numbers, of 2000: a few 1e-4 px.
    EXPECT_LT((spot->centre - at).norm(), 2e-3) << fraction;
  }
}

TEST(WindowedCentroid, IsEmptyWithoutLightOrAtTheEdge) {
  const std::vector<std::uint16_t> black(2400, 64);
  EXPECT_FALSE(windowed_centroid(black, 60, {30.0, 20.0}, 64.0, 1.2, 100.0));
  EXPECT_FALSE(windowed_centroid(spot_at({3.0, 20.0}, 1.0), 60, {3.0, 20.0}, 64.0, 1.2, 100.0));
}

SelfCheckFigures good() {
  SelfCheckFigures figures;
  figures.dots = 40;
  figures.residual_arcsec = 1.0;
  figures.brightness = figures.noise = figures.offset = 1.0;
  return figures;
}

TEST(SelfCheck, AcceptsAGoodBench) {
  EXPECT_EQ(complaint_of(good()), "");
}

TEST(SelfCheck, NamesEachFigureThatFails) {
  const auto complaint = [](auto change) {
    SelfCheckFigures figures = good();
    change(figures);
    return complaint_of(figures);
  };
  EXPECT_THAT(complaint([](auto& f) { f.residual_arcsec = 3.4; }), HasSubstr("residual 3.4 arcsec"));
  EXPECT_THAT(complaint([](auto& f) { f.dots = 30; }), HasSubstr("30 of 40"));
  EXPECT_THAT(complaint([](auto& f) { f.correction.shift_px = {2.1, 0.0}; }), HasSubstr("moved by 2.10"));
  EXPECT_THAT(complaint([](auto& f) { f.correction.scale = 1.0003; }), HasSubstr("300 ppm"));
  EXPECT_THAT(complaint([](auto& f) { f.brightness = 0.9; }), HasSubstr("brightness 0.900"));
  EXPECT_THAT(complaint([](auto& f) { f.noise = 1.3; }), HasSubstr("noise 1.300"));
  EXPECT_THAT(complaint([](auto& f) { f.offset = 1.3; }), HasSubstr("offset 1.300"));
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(complaint([](auto& f) { f.residual_arcsec = kNan; }), "");
  EXPECT_NE(complaint([](auto& f) { f.correction.scale = kNan; }), "");
  EXPECT_NE(complaint([](auto& f) { f.brightness = kNan; }), "");
}

}  // namespace
}  // namespace vbar::optical_stimulator
