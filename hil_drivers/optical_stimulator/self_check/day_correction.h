#pragma once
// Shift, rotation and scale of the display since its calibration, from dots.

#include <span>
#include <vector>

#include "fsw/core/types.h"
#include "hil_drivers/optical_stimulator/display_map/display_map.h"

namespace vbar::optical_stimulator {

/// Holds a dot: where the calibrated map says that light seen by the camera comes from, and where it came from. Display
/// px.
struct DotPair {
  fsw::Vector2 by_map{0.0, 0.0};
  fsw::Vector2 shown{0.0, 0.0};
};

struct FittedDay {
  DayCorrection correction;
  std::vector<double> residuals_px;  ///< distances that the correction leaves
};

/// Fits by least squares; `middle` is the display's, about which rotation and scale are. At least two dots at two
/// places.
[[nodiscard]] FittedDay fit_day(std::span<const DotPair> dots, const fsw::Vector2& middle);

}  // namespace vbar::optical_stimulator
