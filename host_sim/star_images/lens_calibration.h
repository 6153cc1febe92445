#pragma once
// Calibration of a lens by identified stars: focal length and distortion, common to all images, and an attitude for
// each, by least squares of the stars' pixels.

#include <vector>

#include "host_sim/star_images/star_fix.h"

namespace vbar::star_images {

struct LensCalibration {
  fsw::imaging::CameraModel camera;  ///< principal point as given: not observable beside a rotation and p1, p2
  double focal_length_sigma_px = 0.0;
  std::vector<double> distortion_sigma;  ///< of k1, k2, p1, p2
  std::vector<StarFix> fixes;            ///< attitudes and residuals with this lens
  double rms_px = 0.0;                   ///< of the stars used
  int stars = 0;                         ///< used
  int outliers = 0;                      ///< left out: beyond four times the root mean square
};

/// Fits from the identified stars of one or more images and their lens. Throws std::runtime_error for fewer than
/// kFewestStars, or if the least squares do not converge. k3 is held.
inline constexpr int kFewestStars = 20;
[[nodiscard]] LensCalibration calibrate_lens(const std::vector<StarFix>& fixes, const fsw::imaging::CameraModel& start);

}  // namespace vbar::star_images
