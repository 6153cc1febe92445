#pragma once
// Blur of a whole image: the lens's point-spread function (Gaussian core and wide halo) and defocus.

#include <vector>

#include "host_sim/twins/camera/camera_settings.h"

namespace vbar::tron::bench {

inline constexpr double kFocusDistanceM = 3.5;

/// Returns the diameter of the circle of confusion on the detector, px, of a thin lens focused at kFocusDistanceM.
[[nodiscard]] double defocus_diameter_px(const twins::camera::CameraSettings& settings, double distance_m);

/// Holds a grid of floats, rows from the top.
struct Plane {
  int width = 0, height = 0;
  std::vector<float> values;
};

inline constexpr int kCoarseStep = 4;  ///< px a cell of a coarse plane

/// Computes fine = keep * fine + share * coarse, linear between the middles of the coarse plane's cells.
void mix_coarse(const Plane& coarse, float keep, float share, Plane& fine);

class LensBlur {
 public:
  /// Replaces `plane` by its blurred image; the plane beyond its edges counts as black. A uniform disc of the
  /// defocus's diameter has the variance d^2/16 along each axis, which is added to the core's.
  void blur(const twins::camera::OpticsSettings& optics, double defocus_px, Plane& plane);

 private:
  Plane across_, coarse_, coarse_half_;
};

/// Returns weights of a Gaussian at whole steps whose sum is 1 and whose variance is sigma^2, the middle one first.
[[nodiscard]] std::vector<float> gaussian_taps(double sigma);

}  // namespace vbar::tron::bench
