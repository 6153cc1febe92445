#pragma once
// Directions of all pixels of a region, kept from image to image: the inverse of the distortion is iterative, and the
// Earth needs it at every pixel.

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "fsw/core/types.h"
#include "host_sim/twins/camera/camera_settings.h"
#include "host_sim/twins/camera/projection.h"

namespace vbar::twins::camera {

class PixelDirections {
 public:
  explicit PixelDirections(std::shared_ptr<const Projection> projection) : projection_(std::move(projection)) {}

  /// Computes those of `region`, if it is another one than that of the last call; 24 bytes a pixel.
  void prepare(const Region& region);

  /// Returns the direction of pixel (x, y) of the detector, within the region: projection.direction_of() to the bit.
  [[nodiscard]] const fsw::Vector3& at(int x, int y) const {
    return directions_[static_cast<std::size_t>(y - region_.y) * static_cast<std::size_t>(region_.width) +
                       static_cast<std::size_t>(x - region_.x)];
  }

 private:
  std::shared_ptr<const Projection> projection_;
  Region region_{};
  std::vector<fsw::Vector3> directions_;
};

}  // namespace vbar::twins::camera
