#pragma once
// From measurements to a calibration, in stages.

#include <functional>
#include <string>
#include <vector>

#include "hil_drivers/tron/calibration/calibration_data.h"
#include "hil_drivers/tron/calibration/chain_fit.h"
#include "hil_drivers/tron/calibration/evaluation.h"
#include "hil_drivers/tron/geometry/calibration.h"

namespace vbar::tron::calibrate {

// Motion capture alone: the order of its angles and the frames of its objects.

struct ViconStart {
  ViconCalibration vicon;
  double rotation_rms_rad = 0.0;  ///< against the poses by the images
};

/// Fits the frames by the null space, then by least squares against the poses by the images with `covariances`, for
/// each order of angles, and returns the best. `assumed`: the order with which the measurements were read. T_V_L is
/// left to the caller.
[[nodiscard]] ViconStart fit_vicon(const std::vector<FitImage>& images, const std::vector<Matrix6>& covariances,
                                   const std::string& assumed);

/// Returns T_V_L from the camera's object and the poses of the camera in the laboratory by the arms.
[[nodiscard]] PoseFigures vicon_of_laboratory(const std::vector<FitImage>& images, const Calibration& calibration);

/// Receives a line of progress.
using Progress = std::function<void(const std::string&)>;

struct CalibrationMeasurements {
  std::vector<Measurement> fitted, judged;  ///< figures are of the second alone
};

struct TestbedFit {
  Calibration calibration;  ///< with covariances and figures; validity, camera and lights are the caller's
  std::vector<EvaluatedPose> fused, arms, vicon;  ///< figures of the judged measurements
};

/// Fits the testbed from the lens as designed. Throws std::runtime_error where the measurements do not determine the
/// testbed.
[[nodiscard]] TestbedFit fit_testbed(const TestbedDesign& bench, const LensCalibration& lens,
                                     const CalibrationMeasurements& measurements, const Progress& progress = {});

}  // namespace vbar::tron::calibrate
