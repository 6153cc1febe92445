// Two lenses and a display: against the trace of rays through thin lenses and the table of the design.

#include "emulators/optical_stimulator/optics.h"

#include <cmath>
#include <cstring>
#include <deque>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "emulators/optical_stimulator/optical_path.h"
#include "emulators/optical_stimulator/screen.h"
#include "tests/unit/emulators/optical_stimulator/bench_fixture.h"

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

// One exposure from the screen to the numbers: the same bits twice, and the faults of an exposure.

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

// The framebuffer file of the X server, and the pictures of an exposure.

namespace {

void set_word(std::vector<std::uint8_t>& file, std::size_t index, std::uint32_t value) {
  for (std::size_t k = 0; k < 4; ++k) file[4 * index + k] = static_cast<std::uint8_t>(value >> (8 * (3 - k)));
}

/// As Xvfb writes it for a screen of 24 bits: header of 160 bytes, 256 colours (X11/XWDFile.h).
std::vector<std::uint8_t> dump_of(std::uint32_t width, std::uint32_t height) {
  std::vector<std::uint8_t> file(160 + 256 * 12 + 4 * width * height, 0);
  const std::uint32_t words[] = {160, 7,  2,         24, width,    height, 0,    0, 32,  0,
                                 32,  32, 4 * width, 4,  0xff0000, 0xff00, 0xff, 8, 256, 256};
  for (std::size_t k = 0; k < std::size(words); ++k) set_word(file, k, words[k]);
  return file;
}

TEST(Xwd, PixelsBeginBehindHeaderAndColours) {
  std::vector<std::uint8_t> file = dump_of(3, 2);
  const XwdLayout layout = read_xwd_layout(file);
  EXPECT_EQ(layout.width, 3);
  EXPECT_EQ(layout.height, 2);
  EXPECT_EQ(layout.pixels, 160U + 256U * 12U);
  for (std::size_t k = 0; k < 6; ++k)
    for (std::size_t byte = 0; byte < 3; ++byte) file[layout.pixels + 4 * k + byte] = static_cast<std::uint8_t>(51 * k);
  file[layout.pixels + 1] = 255;  // green alone
  std::vector<std::uint8_t> grey;
  read_grey(file, layout, grey);
  EXPECT_THAT(grey, ::testing::ElementsAre(182, 51, 102, 153, 204, 255));  // 0.7152 * 255 = 182.4
}

TEST(Xwd, HostileHeadersAreOneError) {
  const std::vector<std::uint8_t> good = dump_of(8, 8);
  for (const auto& [word, value] : std::vector<std::pair<std::size_t, std::uint32_t>>{{0, 0xffffffff},
                                                                                      {1, 6},
                                                                                      {2, 1},
                                                                                      {4, 0},
                                                                                      {4, 0xffffffff},
                                                                                      {5, 9},
                                                                                      {7, 1},
                                                                                      {11, 16},
                                                                                      {12, 31},
                                                                                      {14, 0xff},
                                                                                      {19, 0x7fffffff}}) {
    std::vector<std::uint8_t> file = good;
    set_word(file, word, value);
    EXPECT_THROW((void)read_xwd_layout(file), std::runtime_error) << word;
  }
  for (std::size_t size = 0; size < good.size(); size += 37)
    EXPECT_THROW((void)read_xwd_layout(std::span(good).first(size)), std::runtime_error) << size;
}

std::deque<TimedPicture> three_pictures() {
  std::deque<TimedPicture> shown;
  for (const double begin_s : {0.0, 1.0, 1.5})
    shown.push_back(
        {begin_s, std::make_shared<const std::vector<std::uint8_t>>(1, static_cast<std::uint8_t>(shown.size()))});
  return shown;
}

TEST(Pictures, ShareTheExposureByTime) {
  const Pictures pictures = pictures_of(three_pictures(), 0.8, 1.8, 0.0);
  ASSERT_EQ(pictures.size(), 3U);
  EXPECT_NEAR(pictures[0].fraction, 0.2, 1e-12);
  EXPECT_NEAR(pictures[1].fraction, 0.5, 1e-12);
  EXPECT_NEAR(pictures[2].fraction, 0.3, 1e-12);
  const Pictures later = pictures_of(three_pictures(), 5.0, 5.2, 0.0);
  ASSERT_EQ(later.size(), 1U);
  EXPECT_EQ(later[0].counts->front(), 2);
}

TEST(Pictures, FollowTheResponseOfThePixels) {
  // A step from picture 0 to 1 at 1.0 s with a time constant of 0.1 s, seen from 1.0 to 1.2 s: the first keeps
  // tau (1 - exp(-2)) of the light.
  std::deque<TimedPicture> shown = three_pictures();
  shown.pop_back();
  const Pictures pictures = pictures_of(shown, 1.0, 1.2, 0.1);
  ASSERT_EQ(pictures.size(), 2U);
  EXPECT_NEAR(pictures[0].fraction, 0.1 * (1.0 - std::exp(-2.0)) / 0.2, 1e-12);
  EXPECT_NEAR(pictures[0].fraction + pictures[1].fraction, 1.0, 1e-12);
}

}  // namespace

}  // namespace vbar::optical_stimulator::bench
