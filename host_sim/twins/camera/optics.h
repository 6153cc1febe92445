#pragma once
// The lens: projection of directions onto the detector, and transmission.

#include <optional>

#include "fsw/core/types.h"
#include "host_sim/twins/camera/camera_settings.h"

namespace vbar::twins::camera {

/// A cone of directions.
struct Cone {
  fsw::Vector3 axis = fsw::Vector3::UnitZ();  ///< camera axes, unit
  double half_angle = 0.0;                    ///< rad
};

/// Pinhole with Brown-Conrady distortion (Brown 1966, in OpenCV's order of coefficients). Camera axes: z boresight,
/// x right, y down; pixel coordinates are the detector's, an integer is the centre of a pixel.
class Optics {
 public:
  explicit Optics(const CameraSettings& settings);

  /// Image point of light from `direction_camera` (any length), on the detector or beside it; empty if it is
  /// more than 70 deg off the boresight.
  [[nodiscard]] std::optional<fsw::Vector2> project(const fsw::Vector3& direction_camera) const;

  /// Motion of that point (px/s) as the direction (unit) changes by `rate_camera` (1/s).
  [[nodiscard]] fsw::Vector2 image_velocity(const fsw::Vector3& direction_camera,
                                            const fsw::Vector3& rate_camera) const;

  /// The unit vector that project() sends to `pixel`, by Newton's method from the undistorted one.
  [[nodiscard]] fsw::Vector3 direction_of(const fsw::Vector2& pixel) const;

  /// Transmitted fraction of the light, 1 at the principal point.
  [[nodiscard]] double vignetting(const fsw::Vector2& pixel) const;

  /// The narrowest cone about the region's middle that holds the region grown by `margin_px` on each side.
  [[nodiscard]] Cone cone_of(const Region& region, double margin_px) const;

  [[nodiscard]] double focal_length_px() const { return focal_length_px_; }

 private:
  [[nodiscard]] fsw::Vector2 distort(const fsw::Vector2& plane) const;
  [[nodiscard]] fsw::Matrix2 distortion_slope(const fsw::Vector2& plane) const;

  OpticsSettings settings_;
  double focal_length_px_;
  double corner_px_;  // principal point to the detector's corners, were it in the middle
  fsw::Vector2 principal_point_px_;
};

}  // namespace vbar::twins::camera
