#pragma once
// Map from a direction to the display pixel that sends light to the camera from there. It takes the place of the lens
// when a scene is rendered for the display.

#include <optional>

#include "fsw/core/types.h"
#include "hil_drivers/optical_stimulator/display_map/chebyshev_field.h"
#include "hil_drivers/optical_stimulator/display_map/display_lens.h"
#include "host_sim/twins/camera/projection.h"

namespace vbar::optical_stimulator {

/// Holds the motion of the display since calibration: a rotation and a scale about the display's middle, then a shift.
struct DayCorrection {
  fsw::Vector2 shift_px = fsw::Vector2::Zero();  ///< display pixels
  double rotation_rad = 0.0;
  double scale = 1.0;
};

struct DisplayMapParameters {
  int width_px = 1920, height_px = 1200;  ///< size of the display
  LensTerms lens;
  ChebyshevField field;  ///< added to what the lens terms give
};

/// Maps directions that the camera's own model (twins::camera::Optics of the camera file) assigns to its pixels.
/// Light from the display pixel project(direction) arrives at the camera pixel where that model places `direction`.
class DisplayMap final : public twins::camera::Projection {
 public:
  explicit DisplayMap(const DisplayMapParameters& parameters, const DayCorrection& correction = {});

  /// Returns nothing if the direction is more than 70 deg off the boresight. Beyond the display's corners the
  /// distortion continues in proportion to the angle's tangent: its polynomial would fold distant directions back onto
  /// the display.
  [[nodiscard]] std::optional<fsw::Vector2> project(const fsw::Vector3& direction_camera) const override;
  [[nodiscard]] fsw::Vector2 image_velocity(const fsw::Vector3& direction_camera,
                                            const fsw::Vector3& rate_camera) const override;
  /// Inverts by Newton's method; to 1e-9 px on the display.
  [[nodiscard]] fsw::Vector3 direction_of(const fsw::Vector2& pixel) const override;
  /// Returns 1 everywhere: the light that a display pixel causes in the camera is in the calibration's uniformity.
  [[nodiscard]] double vignetting(const fsw::Vector2& pixel) const override;
  [[nodiscard]] double focal_length_px() const override { return focal_length_px_; }

  [[nodiscard]] const DisplayMapParameters& parameters() const { return parameters_; }

 private:
  struct Point {
    fsw::Vector2 pixel;
    fsw::Matrix2 jacobian;  ///< by the tangent-plane point
  };
  [[nodiscard]] Point lens_point(const fsw::Vector2& plane) const;
  [[nodiscard]] Point point_of(const fsw::Vector2& plane) const;
  [[nodiscard]] fsw::Vector2 plane_of(const fsw::Vector2& pixel) const;
  [[nodiscard]] double corner_radius() const;

  DisplayMapParameters parameters_;
  std::array<double, LensTerms::kCount> lens_;
  fsw::Vector2 middle_px_, shift_px_;
  fsw::Matrix2 correction_;
  double radius_limit_;  ///< limit in the tangent plane: distortion is a polynomial inside
  double focal_length_px_;
};

}  // namespace vbar::optical_stimulator
