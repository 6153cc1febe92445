#pragma once
// A bench of numbers, measured and calibrated.

#include <cstdio>
#include <functional>
#include <stdexcept>
#include <string>

#include "hil_drivers/tron/calibration/pose_choice.h"
#include "hil_drivers/tron/calibration/testbed_fit.h"
#include "tests/support/paths.h"
#include "tests/unit/hil_drivers/tron/calibration/simulated_bench.h"

namespace vbar::tron::calibrate {

inline LensCalibration lens_as_designed() {
  // data/cameras/tron.toml, read as 1600 x 1000 at [160, 100].
  return {1600,
          1000,
          17.0 / 5.86e-3,
          17.0 / 5.86e-3,
          799.5,
          499.5,
          {-0.22383, 0.514098, -0.000664997, -0.000214048, -0.131243}};
}

inline void print(const StageFigures& f) {
  std::printf("%-32s %3d  board %5.2f +- %5.2f (%5.2f) mm  %.3f +- %.3f (%.3f) deg  %.2f +- %.2f (%.2f) px",
              f.stage.c_str(), f.poses, f.board.translation_mean_mm, f.board.translation_sigma_mm,
              f.board.translation_median_mm, f.board.rotation_mean_deg, f.board.rotation_sigma_deg,
              f.board.rotation_median_deg, f.board.pixel_mean_px, f.board.pixel_sigma_px, f.board.pixel_median_px);
  if (f.truth)
    std::printf("  truth %5.2f (%5.2f) mm %.3f (%.3f) deg", f.truth->translation_mean_mm,
                f.truth->translation_median_mm, f.truth->rotation_mean_deg, f.truth->rotation_median_deg);
  std::printf("\n");
}

/// `change`: of each measurement before it is fitted.
inline TestbedFit calibrated(std::uint64_t seed, int fitted, int judged,
                             const std::function<void(Measurement&)>& change = {}) {
  const TestbedDesign file = read_testbed_design(tests::source_path("data/benches/tron.toml"));
  const BoardDesign board;
  SimulatedBench bench(file, lens_as_designed(), seed);
  CalibrationMeasurements measurements;
  for (const Posture& posture :
       choose_postures(file, lens_as_designed(), board, fitted, 100 + seed, {}, free_postures(file)))
    measurements.fitted.push_back(bench.measure(posture));
  for (const Posture& posture :
       choose_postures(file, lens_as_designed(), board, judged, 200 + seed, {}, free_postures(file)))
    measurements.judged.push_back(bench.measure(posture));
  if (change) {
    for (Measurement& measurement : measurements.fitted) change(measurement);
    for (Measurement& measurement : measurements.judged) change(measurement);
  }
  return fit_testbed(file, lens_as_designed(), measurements,
                     [](const std::string& line) { std::printf("%s\n", line.c_str()); });
}

inline const StageFigures& stage(const TestbedFit& fit, const std::string& name) {
  for (const StageFigures& figures : fit.calibration.figures)
    if (figures.stage == name) return figures;
  throw std::runtime_error("no stage " + name);
}

}  // namespace vbar::tron::calibrate
