#include "host_sim/twins/camera/projection.h"

#include <algorithm>
#include <cmath>

namespace vbar::twins::camera {

using fsw::Vector2;

Cone Projection::cone_of(const Region& region, double margin_px) const {
  const double left = region.x - 0.5 - margin_px, right = region.x + region.width - 0.5 + margin_px;
  const double top = region.y - 0.5 - margin_px, bottom = region.y + region.height - 0.5 + margin_px;
  Cone cone;
  cone.axis = direction_of({0.5 * (left + right), 0.5 * (top + bottom)});
  for (const Vector2& corner :
       {Vector2(left, top), Vector2(right, top), Vector2(left, bottom), Vector2(right, bottom)}) {
    const double cosine = std::min(1.0, cone.axis.dot(direction_of(corner)));
    cone.half_angle = std::max(cone.half_angle, std::acos(cosine));
  }
  return cone;
}

}  // namespace vbar::twins::camera
