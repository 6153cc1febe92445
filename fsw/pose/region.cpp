#include "fsw/pose/region.h"

#include "fsw/math/math.h"

namespace vbar::fsw::pose {

double radius_of(const KeypointShape& shape) {
  double radius = 0.0;
  for (const Vector3& point : shape) {
    const double length = math::sqrt(point.squaredNorm());
    if (length > radius) radius = length;
  }
  return radius;
}

Result<CropRegion> region_of(const Vector3& position_camera_m, const imaging::CameraModel& model,
                             const KeypointShape& shape) {
  const Result<Vector2> centre = imaging::pixel_of(model, position_camera_m);
  if (!centre.ok()) return Status::kOutOfRange;
  const double focal_length_px = 0.5 * (model.focal_length_px.x() + model.focal_length_px.y());
  const double range = math::sqrt(position_camera_m.squaredNorm());
  CropRegion region;
  region.centre_px = centre.value();
  region.side_px = kCropRadii * radius_of(shape) * focal_length_px / range;
  if (!math::is_finite(region.side_px)) return Status::kOutOfRange;
  return region;
}

}  // namespace vbar::fsw::pose
