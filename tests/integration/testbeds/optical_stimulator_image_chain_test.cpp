// The driver of the optical testbed with the true optics and the detector of the emulated bench: no process, no wire.

#include <gtest/gtest.h>

#include "tests/integration/testbeds/driver_chain.h"

namespace vbar::optical_stimulator {
namespace {

struct InProcess {
  bench::BenchSettings settings;
  CameraSettings camera = bench::camera_of(settings, tests::source_path("data"));
  PathBench path{settings, camera, region_with_strip(CameraSettings{}.region)};
  Chain chain{true_calibration(settings, camera, {}), path, path};
};

TEST(OpticalChain, ImagesAreThoseOfTheTwinForTheFlightSoftware) {
  InProcess bench;
  expect_images_as_of_the_twin(bench.chain);
}

TEST(OpticalChain, SelfCheckAcceptsTheBenchAndMeasuresWhatHasChanged) {
  InProcess bench;
  Chain& chain = bench.chain;
  const SelfCheckFigures calibrated = chain.check();
  EXPECT_EQ(complaint_of(calibrated), "");
  EXPECT_LT(calibrated.residual_arcsec, 1.0);
  EXPECT_LT(calibrated.correction.shift_px.norm(), 0.02);
  EXPECT_LT(calibrated.new_hot_pixels, 20);
  std::printf("residual %.2f arcsec, shift %.3f px, scale %.1f ppm, brightness %.3f, noise %.3f, offset %.4f, hot %d\n",
              calibrated.residual_arcsec, calibrated.correction.shift_px.norm(),
              1e6 * (calibrated.correction.scale - 1.0), calibrated.brightness, calibrated.noise, calibrated.offset,
              calibrated.new_hot_pixels);

  // 1 um of 9.6 um pixels is compensated.
  bench.path.path().bump(1.0, 0.0);
  const SelfCheckFigures moved = chain.check();
  EXPECT_EQ(complaint_of(moved), "");
  EXPECT_NEAR((moved.correction.shift_px - calibrated.correction.shift_px).norm(), 1.0 / 9.6, 0.01);
  chain.place(moved.correction);
  const SelfCheckFigures corrected = chain.check();
  EXPECT_LT(corrected.correction.shift_px.norm(), 0.02);
  // 20 um are refused.
  bench.path.path().bump(20.0, 0.0);
  EXPECT_NE(complaint_of(chain.check()), "");
}

}  // namespace
}  // namespace vbar::optical_stimulator
