#pragma once
// The lens: projection of directions onto the detector, and transmission.

#include <optional>

#include "fsw/core/types.h"
#include "host_sim/twins/camera/camera_settings.h"
#include "host_sim/twins/camera/projection.h"

namespace vbar::twins::camera {

/// Lens as a pinhole with Brown-Conrady distortion (Brown 1966, in OpenCV's order of coefficients). Camera axes: z
/// boresight, x right, y down; pixel coordinates are the detector's.
class Optics final : public Projection {
 public:
  explicit Optics(const CameraSettings& settings);

  /// Projects a direction; empty if the direction is more than 70 deg off the boresight.
  [[nodiscard]] std::optional<fsw::Vector2> project(const fsw::Vector3& direction_camera) const override;
  [[nodiscard]] fsw::Vector2 image_velocity(const fsw::Vector3& direction_camera,
                                            const fsw::Vector3& rate_camera) const override;
  /// Inverts the projection by Newton's method from the undistorted one.
  [[nodiscard]] fsw::Vector3 direction_of(const fsw::Vector2& pixel) const override;
  /// Returns the transmission relative to that at the principal point, 1 at the principal point.
  [[nodiscard]] double vignetting(const fsw::Vector2& pixel) const override;
  [[nodiscard]] double focal_length_px() const override { return focal_length_px_; }

 private:
  [[nodiscard]] fsw::Vector2 distort(const fsw::Vector2& plane) const;
  [[nodiscard]] fsw::Matrix2 distortion_slope(const fsw::Vector2& plane) const;

  OpticsSettings settings_;
  double focal_length_px_;
  double corner_px_;  // principal point to the detector's corners, were it in the middle
  fsw::Vector2 principal_point_px_;
};

}  // namespace vbar::twins::camera
