#pragma once
// Least squares of the lens terms of the display map.

#include <array>
#include <vector>

#include "fsw/core/types.h"
#include "hil_drivers/optical_stimulator/optics/display_map.h"

namespace vbar::optical_stimulator::calibrate {

/// Holds a displayed dot and where the camera saw it.
struct Dot {
  fsw::Vector2 display_px;        ///< centre of its light on the display
  fsw::Vector2 camera_px;         ///< measured
  fsw::Vector3 direction_camera;  ///< direction of camera_px by the camera's own model, unit
};

struct LensFit {
  LensTerms lens;
  LensTerms sigma;  ///< standard deviations by the residuals; zero for terms held fixed
  bool converged = false;
};

enum class LensFreedom { kPose, kAll };  ///< kPose: centre, scale and rotation

/// Fits from `start`. The loss grows as the logarithm beyond `outlier_px` (Cauchy), so that a dot that was mistaken for
/// another has little weight.
[[nodiscard]] LensFit fit_lens(const std::vector<Dot>& dots, const LensTerms& start, LensFreedom freedom,
                               double outlier_px);

}  // namespace vbar::optical_stimulator::calibrate
