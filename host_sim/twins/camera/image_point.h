#pragma once
// A point of light on the detector.

#include "fsw/core/types.h"

namespace vbar::twins::camera {

/// A point of an image.
struct ImagePoint {
  fsw::Vector2 pixel = fsw::Vector2::Zero();  ///< at the middle of the exposure
  double electrons = 0.0;                     ///< in total
};

}  // namespace vbar::twins::camera
