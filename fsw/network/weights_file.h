#pragma once
// A weights file in memory (architecture.h has its layout).

#include <cstddef>
#include <span>

#include "fsw/core/result.h"

namespace vbar::fsw::network {

/// What was found on images that training never saw, and what use of the maps goes by.
struct Calibration {
  float covariance_scale = 1.0F;    ///< of a map's second moments, less the training target's own
  float covariance_floor = 0.0F;    ///< added to each axis, cells^2
  float target_sigma_cells = 1.0F;  ///< of the Gaussian maps that training asked for
  float least_peak = 0.0F;          ///< a map whose highest 3 x 3 cells hold less tells nothing
  /// Places are to be so much, as a share, farther from the crop's middle than the maps have them: a network that does
  /// not know how large the target is leans towards the size it saw most.
  float stretch = 0.0F;
};

/// Is it such a file, of this architecture, whole, and every number in its range? What load() answers.
Status check_weights_file(std::span<const std::byte> file);

/// Of a file that was checked.
Calibration calibration_of(std::span<const std::byte> file);

}  // namespace vbar::fsw::network
