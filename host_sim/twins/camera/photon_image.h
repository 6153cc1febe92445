#pragma once
// The noise-free image: expected photo-electrons per pixel of one exposure.

#include <cstddef>
#include <vector>

#include "fsw/core/types.h"
#include "host_sim/twins/camera/camera_settings.h"

namespace vbar::twins::camera {

struct PhotonImage {
  Region region;                 ///< region of the detector
  std::vector<float> electrons;  ///< rows from the top, pixels from the left; no upper limit

  [[nodiscard]] float& at(int x, int y) {  ///< detector coordinates
    return electrons[static_cast<std::size_t>(y - region.y) * static_cast<std::size_t>(region.width) +
                     static_cast<std::size_t>(x - region.x)];
  }
};

// A point of light on the detector.

/// A point of an image.
struct ImagePoint {
  fsw::Vector2 pixel = fsw::Vector2::Zero();  ///< at the middle of the exposure
  double electrons = 0.0;                     ///< in total
};

}  // namespace vbar::twins::camera
