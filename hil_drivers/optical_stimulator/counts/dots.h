#pragma once
// Dots of known place and light, for calibration and self check.

#include "fsw/core/types.h"
#include "hil_drivers/optical_stimulator/counts/display_light.h"

namespace vbar::optical_stimulator {

/// Draws a Gaussian dot of that total light and sigma about `centre` with matched counts, over what the picture shows
/// there. False, and nothing drawn, if its patch does not lie on the picture. At most a full pixel's light is put on a
/// pixel.
bool draw_dot(const DisplayLight& light, const fsw::Vector2& centre, double sigma_px, double electrons,
              Picture& picture);

}  // namespace vbar::optical_stimulator
