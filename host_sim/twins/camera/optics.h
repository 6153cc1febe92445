#pragma once
// From directions to the pixels of an image: the lens of a camera, or the calibrated map of a display that shows a
// camera its sky.

#include <cstddef>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "fsw/core/types.h"
#include "host_sim/twins/camera/camera_settings.h"

namespace vbar::twins::camera {

/// A cone of directions.
struct Cone {
  fsw::Vector3 axis = fsw::Vector3::UnitZ();  ///< camera axes, unit
  double half_angle = 0.0;                    ///< rad
};

/// Map from directions to pixels. Camera axes: z boresight, x right, y down. Pixel coordinates are those of the image;
/// an integer is the centre of a pixel.
class Projection {
 public:
  virtual ~Projection() = default;

  /// Returns the image point of light from `direction_camera` (any length), on the image or beside it; empty if the
  /// projection is not defined there.
  [[nodiscard]] virtual std::optional<fsw::Vector2> project(const fsw::Vector3& direction_camera) const = 0;

  /// Returns the motion of the image point (px/s) as the direction (unit) changes by `rate_camera` (1/s).
  [[nodiscard]] virtual fsw::Vector2 image_velocity(const fsw::Vector3& direction_camera,
                                                    const fsw::Vector3& rate_camera) const = 0;

  /// Returns the unit vector that project() sends to `pixel`.
  [[nodiscard]] virtual fsw::Vector3 direction_of(const fsw::Vector2& pixel) const = 0;

  /// Returns the transmitted fraction of the light, 1 where nothing is lost.
  [[nodiscard]] virtual double vignetting(const fsw::Vector2& pixel) const = 0;

  /// Returns the pixels per radian on the boresight.
  [[nodiscard]] virtual double focal_length_px() const = 0;

  /// Returns the narrowest cone about the region's middle that holds the region grown by `margin_px` on each side.
  [[nodiscard]] Cone cone_of(const Region& region, double margin_px) const;
};

// The lens: projection of directions onto the detector, and transmission.

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

// Directions of all pixels of a region, kept from image to image: the inverse of the distortion is iterative, and the
// Earth needs it at every pixel.

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
