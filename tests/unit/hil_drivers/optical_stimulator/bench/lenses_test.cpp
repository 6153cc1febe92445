// Two lenses and a display: against the trace of rays through thin lenses and the table of the design.

#include "hil_drivers/optical_stimulator/bench/light/lenses.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/unit/hil_drivers/optical_stimulator/bench/bench_fixture.h"

namespace vbar::optical_stimulator::bench {
namespace {

constexpr double kArcsec = std::numbers::pi / 648000.0;

/// A ray at height h with the angle a.
struct TracedRay {
  double h, a;

  [[nodiscard]] TracedRay across(double distance) const { return {h + distance * a, a}; }
  [[nodiscard]] TracedRay through(double f) const { return {h, a - h / f}; }
};

/// From a point of the display at height `height` to the camera.
TracedRay traced(const LensPair& lenses, double display_mm, double height, double angle) {
  return TracedRay{height, angle}
      .across(display_mm)
      .through(lenses.f2_mm)
      .across(lenses.separation_mm)
      .through(lenses.f1_mm);
}

TEST(Lenses, RaysOfOnePointLeaveParallelAtHeightOverFocalLength) {
  for (const double separation : {20.0, 40.0, 60.0}) {
    const LensPair lenses{100.0, 80.0, separation};
    const TracedRay a = traced(lenses, lenses.infinity_mm(), 3.0, 0.0);
    const TracedRay b = traced(lenses, lenses.infinity_mm(), 3.0, 0.07);
    EXPECT_NEAR(a.a, b.a, 1e-15);
    EXPECT_NEAR(std::abs(a.a), 3.0 / lenses.focal_length_mm(), 1e-15);
  }
}

TEST(Lenses, TableOfTheDesign) {
  struct Row {
    double separation_mm, focal_length_mm, field_deg;
  };
  for (const Row& row : {Row{20.0, 50.0, 20.9}, Row{40.0, 57.1, 18.3}, Row{60.0, 66.7, 15.7}}) {
    const LensPair lenses{100.0, 80.0, row.separation_mm};
    EXPECT_NEAR(lenses.focal_length_mm(), row.focal_length_mm, 0.05);
    const double half_mm = 0.5 * 1920 * 9.6e-3;
    EXPECT_NEAR(2.0 * std::atan(half_mm / lenses.focal_length_mm()) * 180.0 / std::numbers::pi, row.field_deg, 0.05);
  }
  const LensPair lenses;
  EXPECT_NEAR(lenses.infinity_mm(), 34.3, 0.05);
  EXPECT_NEAR(std::atan(9.6e-3 / lenses.focal_length_mm()) / kArcsec, 34.7, 0.05);
}

TEST(BenchOptics, ADisplayOutOfFocusAppearsSmallerAndBlurred) {
  test::Light bench(test::perfect_bench());
  const auto& camera = bench.camera;
  const SeenPixel sharp = bench.optics.seen(1359.5, 599.5);
  BenchState state = bench.optics.state();
  state.display_mm += 0.05;
  bench.optics.set_state(state);
  const SeenPixel blurred = bench.optics.seen(1359.5, 599.5);
  const double f = 400.0 / 7.0;
  const double radius_px = sharp.pixel.x() - 959.5;
  EXPECT_NEAR(blurred.pixel.x() - sharp.pixel.x(), -radius_px * 0.05 / (f + 0.05), 1e-6);
  // 12 arcsec at 400 px from the axis (design table).
  EXPECT_NEAR(radius_px * 0.05 / f / camera.focal_length_px() / kArcsec, 12.0, 0.2);
  const double disc_px = camera.focal_length_px() * (35.0 / 1.9) * 0.05 / (f * f);
  EXPECT_NEAR(blurred.sigma_px, std::hypot(0.85, 0.25 * disc_px), 1e-9);
  EXPECT_NEAR(sharp.sigma_px, 0.85, 1e-9);
}

TEST(BenchOptics, ADisplayMovedByAMicrometreMovesByThreeArcsec) {
  test::Light bench(test::perfect_bench());
  const auto before = bench.optics.detector_pixel(959.5, 599.5);
  BenchState state = bench.optics.state();
  state.display_moved_um = {1.0, 0.0};
  bench.optics.set_state(state);
  const double moved = (bench.optics.detector_pixel(959.5, 599.5) - before).x() / bench.camera.focal_length_px();
  EXPECT_NEAR(moved / kArcsec, 3.6, 0.05);  // 1 um / 57.1 mm
}

TEST(BenchOptics, InverseFindsThePlaceOnTheDisplay) {
  const test::Light bench(test::default_bench());
  for (const double u : {0.0, 400.3, 959.5, 1919.0})
    for (const double v : {0.0, 333.3, 1199.0}) {
      const auto place = bench.optics.display_pixel(bench.optics.detector_pixel(u, v));
      EXPECT_NEAR(place.x(), u, 1e-6);
      EXPECT_NEAR(place.y(), v, 1e-6);
    }
}

TEST(BenchOptics, SolidAngleIsTheAreaBetweenTheDirectionsOfNeighbours) {
  BenchSettings settings = test::default_bench();
  settings.field.direction_arcsec = 0.0;
  settings.field.light = 0.0;
  const test::Light bench(settings);
  for (const double u : {100.0, 959.5, 1800.0}) {
    const double v = 300.0, h = 0.5;
    const fsw::Vector2 dx = bench.optics.detector_pixel(u + h, v) - bench.optics.detector_pixel(u - h, v);
    const fsw::Vector2 dy = bench.optics.detector_pixel(u, v + h) - bench.optics.detector_pixel(u, v - h);
    const double area = std::abs(dx.x() * dy.y() - dx.y() * dy.x()) / std::pow(bench.camera.focal_length_px(), 2);
    // The tilt's share of the area is in the difference only: 6 mrad times 0.16.
    EXPECT_NEAR(bench.optics.seen(u, v).solid_angle / area, 1.0, 2e-3);
  }
}

TEST(ErrorField, HasTheRmsAndTheSmoothnessAskedFor) {
  const FieldSettings settings;
  double squares = 0.0, light = 0.0;
  int count = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const ErrorField field(settings, seed, 1920, 1200);
    for (int v = 0; v < 1200; v += 100)
      for (int u = 0; u < 1920; u += 100, ++count) {
        const FieldError error = field.at(u, v);
        squares += 0.5 * (error.x * error.x + error.y * error.y);
        light += error.light * error.light;
      }
  }
  // 60 waves of random phase, 20 draws: within a fifth.
  EXPECT_NEAR(std::sqrt(squares / count) / kArcsec, 15.0, 3.0);
  EXPECT_NEAR(std::sqrt(light / count), 0.05, 0.02);
}

TEST(ErrorField, InterpolationIsExactToAThousandthOfAnArcsecond) {
  // The sum of the same waves at the nodes of a shifted grid: a field made for a display that begins half a step later
  // cannot be had, so smoothness is checked: fourth differences of neighbours 4 px apart.
  const ErrorField field({60, 300.0, 15.0, 0.05}, 3, 1920, 1200);
  for (int u = 40; u < 1880; u += 7) {
    const double fourth = field.at(u - 8, 600).x - 4 * field.at(u - 4, 600).x + 6 * field.at(u, 600).x -
                          4 * field.at(u + 4, 600).x + field.at(u + 8, 600).x;
    EXPECT_NEAR(fourth / kArcsec, 0.0, 2e-3);
  }
}

}  // namespace
}  // namespace vbar::optical_stimulator::bench
