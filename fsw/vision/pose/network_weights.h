#pragma once
// A weights file in memory (architecture.h has its layout).

#include <cstddef>
#include <span>

#include "fsw/core/result.h"

namespace vbar::fsw::pose {

/// Calibration on images that were not used in training.
struct Calibration {
  float covariance_scale = 1.0F;    ///< factor of a heatmap's second moments, less the training target's variance
  float covariance_floor = 0.0F;    ///< added to each axis, cells^2
  float target_sigma_cells = 1.0F;  ///< sigma of the Gaussian that is the training target
  float least_peak = 0.0F;          ///< minimum share of the probability in the highest 3 x 3 cells
  /// Factor, as a share, by which positions are moved away from the crop's centre: since the scale of the target is not
  /// observable, the network is biased towards the mean scale of its training data.
  float stretch = 0.0F;
};

/// Returns kOk for a valid weights file of this architecture, complete, with all values in range: the result of load().
Status check_weights_file(std::span<const std::byte> file);

/// Returns the calibration of a file that was checked.
Calibration calibration_of(std::span<const std::byte> file);

}  // namespace vbar::fsw::pose
