#pragma once
// Motion capture alone: the order of its angles and the frames of its objects.

#include <vector>

#include "hil_drivers/tron/calibrate/fit/chain_fit.h"

namespace vbar::tron::calibrate {

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

}  // namespace vbar::tron::calibrate
