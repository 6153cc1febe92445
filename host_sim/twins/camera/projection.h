#pragma once
// From directions to the pixels of an image: the lens of a camera, or the calibrated map of a display that shows a
// camera its sky.

#include <optional>

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

}  // namespace vbar::twins::camera
