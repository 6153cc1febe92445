#pragma once
// From measurements to a calibration, in stages.

#include <functional>
#include <string>
#include <vector>

#include "hil_drivers/tron/calibrate/data/measurement.h"
#include "hil_drivers/tron/calibrate/stages/evaluation.h"
#include "hil_drivers/tron/calibration_file/calibration.h"

namespace vbar::tron::calibrate {

/// Receives a line of progress.
using Progress = std::function<void(const std::string&)>;

struct BenchMeasurements {
  std::vector<Measurement> fitted, judged;  ///< figures are of the second alone
};

struct BenchFit {
  Calibration calibration;  ///< with covariances and figures; validity, camera and lights are the caller's
  std::vector<EvaluatedPose> fused, arms, vicon;  ///< figures of the judged measurements
};

/// Fits the testbed from the lens as designed. Throws std::runtime_error where the measurements do not determine the
/// testbed.
[[nodiscard]] BenchFit fit_bench(const BenchFile& bench, const LensCalibration& lens,
                                 const BenchMeasurements& measurements, const Progress& progress = {});

}  // namespace vbar::tron::calibrate
