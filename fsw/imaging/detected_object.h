#pragma once
// Objects found by image processing: stars, satellites, hot pixels, not yet distinguished.

#include <cstddef>

#include "fsw/core/types.h"

namespace vbar::fsw::imaging {

inline constexpr std::size_t kMaxObjects = 256;

struct DetectedObject {
  Vector2 centroid_px = Vector2::Zero();  ///< mean of brightness, on the detector; an integer is a pixel's centre
  double sigma_px = 0.0;                  ///< 1 sigma of the centroid, each axis, by photon and read noise
  double flux_dn = 0.0;                   ///< above the background, all its pixels
  int peak_dn = 0;                        ///< brightest pixel, background included
  int pixels = 0;                         ///< above the threshold
  /// Share of the light in the brightest pixel: a quarter at most for a point in focus, nearly all for a hot pixel.
  double sharpness = 0.0;
  double radius_px = 0.0;     ///< root of the larger eigenvalue of its second moments
  bool is_saturated = false;  ///< at least one pixel is saturated
  bool is_cut = false;        ///< the object touches the edge of the image or a missing pixel
};

}  // namespace vbar::fsw::imaging
