// One exposure from the screen to the numbers: the same bits twice, and the faults of an exposure.

#include "hil_drivers/optical_stimulator/bench/optical_path.h"

#include <gtest/gtest.h>

#include "tests/unit/hil_drivers/optical_stimulator/bench/bench_fixture.h"

namespace vbar::optical_stimulator::bench {
namespace {

const ExposureRequest kRegion{{710, 152, 500, 848}, {0.2, 0.0, 64.0}};
const RailPlaces kInFocus{40.0, 34.2857142857142857};

Pictures stars(const BenchSettings& bench) {
  test::Frame frame(bench);
  for (int k = 0; k < 200; ++k)
    frame.at(720 + 37 * k % 480, 170 + 71 * k % 800) = static_cast<std::uint8_t>(60 + k % 190);
  return {{std::make_shared<const std::vector<std::uint8_t>>(frame.counts), 1.0}};
}

TEST(OpticalPath, RepeatsBitForBit) {
  const BenchSettings bench = test::default_bench({"seed=3", "drift.day=1"});
  const auto camera = camera_of(bench, mission::data_directory());
  OpticalPath a(bench, camera), b(bench, camera);
  std::vector<std::uint16_t> first, second, warm_up;
  // Other exposures before leave no trace.
  b.expose(stars(bench), {{0, 0, 1920, 1200}, {0.1, 0.0, 64.0}}, {39.0, 34.0}, {}, 1, warm_up);
  for (const std::uint64_t frame : {0U, 1U, 200U}) {
    a.expose(stars(bench), kRegion, kInFocus, {}, frame, first);
    b.expose(stars(bench), kRegion, kInFocus, {}, frame, second);
    EXPECT_EQ(first, second);
  }
  a.expose(stars(bench), kRegion, kInFocus, {}, 201, second);
  EXPECT_NE(first, second);
}

TEST(OpticalPath, SeedsAreDifferentBenches) {
  const BenchSettings one = test::default_bench({"seed=1"}), two = test::default_bench({"seed=2"});
  const auto camera = camera_of(one, mission::data_directory());
  const OpticalPath a(one, camera), b(two, camera);
  const double apart = (a.optics().detector_pixel(500.0, 500.0) - b.optics().detector_pixel(500.0, 500.0)).norm();
  EXPECT_GT(apart, 0.02);
  EXPECT_LT(apart, 5.0);
}

TEST(OpticalPath, FaultsOfAnExposureChangeItsLight) {
  BenchSettings bench = test::perfect_bench();
  bench.light.contrast = 1e12;
  OpticalPath path(bench, camera_of(bench, mission::data_directory()));
  test::Frame frame(bench);
  frame.at(960, 600) = 50;  // 58,000 e, a fifth of them in one pixel: below the full well
  const Pictures pictures{{std::make_shared<const std::vector<std::uint8_t>>(frame.counts), 1.0}};
  const auto light = [&](const ExposureFaults& faults) {
    std::vector<std::uint16_t> dn;
    path.expose(pictures, kRegion, kInFocus, faults, 0, dn);
    double sum = 0.0;
    for (const std::uint16_t value : dn) sum += static_cast<double>(value) - 64.0;
    return sum;
  };
  const double normal = light({});
  ExposureFaults longer, brighter, louder;
  longer.exposure_factor = brighter.brightness_factor = louder.gain_factor = 1.1;
  for (const ExposureFaults& faults : {longer, brighter, louder})
    EXPECT_NEAR(light(faults) / normal, 1.1, 0.02);  // the halo is less than half a number a pixel
}

TEST(OpticalPath, ABumpDisplacesTheImage) {
  const BenchSettings bench = test::perfect_bench();
  OpticalPath path(bench, camera_of(bench, mission::data_directory()));
  std::vector<std::uint16_t> dn;
  path.expose(stars(bench), kRegion, kInFocus, {}, 0, dn);
  const auto before = path.optics().detector_pixel(960.0, 600.0);
  path.bump(20.0, -10.0);
  path.expose(stars(bench), kRegion, kInFocus, {}, 1, dn);
  const fsw::Vector2 moved = path.optics().detector_pixel(960.0, 600.0) - before;
  const double px_per_um = 5972.7 / (400.0 / 7.0 * 1e3);
  EXPECT_NEAR(moved.x(), 20.0 * px_per_um, 1e-3);
  EXPECT_NEAR(moved.y(), -10.0 * px_per_um, 1e-3);
}

}  // namespace
}  // namespace vbar::optical_stimulator::bench
