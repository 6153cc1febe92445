#include "fsw/measurements/keypoints/resolution.h"

#include <algorithm>

#include "fsw/math/math.h"
#include "fsw/vision/pose/crop.h"

namespace vbar::fsw::measurements {
namespace {

// A range less certain than this, 1 sigma over its value, does not determine the size of the image.
constexpr double kKnownShare = 0.2;
// From here on more pixels do not improve the image.
constexpr double kFullScale = 2.2;

}  // namespace

double image_scale(const KeypointCameraSettings& camera, double range_m) {
  const auto& focal_length_px = camera.network.model.focal_length_px;
  const double px_per_m = 0.5 * (focal_length_px.x() + focal_length_px.y()) / range_m;
  return pose::kCropRadii * pose::radius_of(camera.network.shape) * px_per_m / pose::kCropSide;
}

double lasting_stretch_scale(double image_scale) {
  const double shortfall = kFullScale / image_scale;
  return shortfall > 1.0 ? shortfall * shortfall : 1.0;
}

Resolution resolution_of(const KeypointCameraSettings& camera, const filter::RelativeNavigationFilter& filter,
                         Resolution before, const ResolutionLimits& limits) {
  const Result<orbit::CartesianState> target = filter.target();
  if (!target.ok()) return Resolution::kUnknown;
  const Vector3 apart = target.value().position_eci - filter.servicer().position_eci;
  const double square = apart.squaredNorm();
  if (!(square > 0.0)) return Resolution::kUnknown;
  const Matrix3 covariance = filter.position_covariance_eci();
  const double along_variance = apart.dot(covariance * apart) / square;
  if (!(along_variance <= kKnownShare * kKnownShare * square)) return Resolution::kUnknown;

  const double range = math::sqrt(square);
  const double side_m = pose::kCropRadii * pose::radius_of(camera.network.shape);
  const double scale = image_scale(camera, range);
  const double span_px = 2.0 / pose::kCropRadii * scale * pose::kCropSide;
  const int shorter_px = std::min(camera.network.frame.width, camera.network.frame.height);
  if (span_px > shorter_px) return Resolution::kTooLarge;

  const bool was_resolved = before == Resolution::kResolved || before == Resolution::kTooLarge;
  if (was_resolved) return scale >= limits.stop_scale ? Resolution::kResolved : Resolution::kTooSmall;
  const double lateral_sigma = math::sqrt(std::max(0.0, covariance.trace() - along_variance));
  const bool is_well_known = 3.0 * lateral_sigma <= limits.start_lateral_share * side_m;
  return scale >= limits.start_scale && is_well_known ? Resolution::kResolved : Resolution::kTooSmall;
}

}  // namespace vbar::fsw::measurements
