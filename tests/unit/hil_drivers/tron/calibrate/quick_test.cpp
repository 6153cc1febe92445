// A short calibration of a bench of numbers: its whole path, and another order of the angles of motion capture.

#include <gtest/gtest.h>

#include "tests/unit/hil_drivers/tron/calibrate/calibrated_bench.h"

namespace vbar::tron::calibrate {
namespace {

// With a third of the postures the goals of the whole calibration are kept with a margin of half.
TEST(QuickCalibration, FindsBenchAndOrderOfAngles) {
  const BenchFit fit = calibrated(1, 70, 25, [](Measurement& measurement) {
    if (!measurement.vicon) return;
    // The bench's angles are in the order zyx; the bench file, by which they were read, says xyz.
    measurement.vicon->T_V_camera = reordered(measurement.vicon->T_V_camera, "zyx", "xyz");
    measurement.vicon->T_V_target = reordered(measurement.vicon->T_V_target, "zyx", "xyz");
  });
  EXPECT_EQ(fit.calibration.vicon.rotation, "zyx");
  const StageFigures& fused = stage(fit, "fused");
  ASSERT_TRUE(fused.truth.has_value());
  EXPECT_GE(fused.poses, 23);
  EXPECT_LE(fused.truth->translation_median_mm, 3.0);
  EXPECT_LE(fused.truth->rotation_median_deg, 0.2);
  EXPECT_LE(fused.board.pixel_median_px, 2.0);
  const StageFigures& vicon = stage(fit, "motion capture alone");
  EXPECT_LE(vicon.truth->rotation_median_deg, 0.5);  // the wrong order is off by degrees
  // What the driver reads is what was fitted.
  const Calibration read = parse_calibration(toml_of(fit.calibration), "calibration.toml");
  EXPECT_EQ(toml_of(read), toml_of(fit.calibration));
}

TEST(QuickCalibration, WithoutTheBoardIsRefused) {
  EXPECT_THROW(static_cast<void>(calibrated(1, 25, 5, [](Measurement& measurement) { measurement.corners.clear(); })),
               std::runtime_error);
}

TEST(QuickCalibration, WithoutMotionCaptureIsRefused) {
  EXPECT_THROW(static_cast<void>(calibrated(1, 30, 5, [](Measurement& measurement) { measurement.vicon.reset(); })),
               std::runtime_error);
}

}  // namespace
}  // namespace vbar::tron::calibrate
