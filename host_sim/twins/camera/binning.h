#pragma once
// Binning: the charges of b x b neighbouring pixels summed into one before they are read as a number.

#include "host_sim/twins/camera/camera_settings.h"

namespace vbar::twins::camera {

/// Returns the camera whose pixels are the sums, from `single`, the camera with single pixels; `binning` is 1 or more.
/// Lengths in pixels and the detector's sides shrink (a fraction of a pixel at the right and lower edge is lost), an
/// integer stays the centre of a pixel. Full well, dark current and stray light of a sum are b^2 those of a pixel; read
/// noise, b^2 readings added, is b times one, and a relative non-uniformity 1/b. The gain is reduced such that a full
/// sum reads what a full pixel did, and the region covers the same part of the detector. Hot pixels stay as many and as
/// hot, one to a sum.
[[nodiscard]] CameraSettings binned(const CameraSettings& single, int binning);

}  // namespace vbar::twins::camera
