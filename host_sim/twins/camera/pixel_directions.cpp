#include "host_sim/twins/camera/pixel_directions.h"

namespace vbar::twins::camera {

void PixelDirections::prepare(const Region& region) {
  if (!directions_.empty() && region == region_) return;
  region_ = region;
  directions_.clear();
  directions_.reserve(static_cast<std::size_t>(region.width) * static_cast<std::size_t>(region.height));
  for (int y = region.y; y < region.y + region.height; ++y)
    for (int x = region.x; x < region.x + region.width; ++x)
      directions_.push_back(projection_->direction_of(fsw::Vector2(x, y)));
}

}  // namespace vbar::twins::camera
