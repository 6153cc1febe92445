#pragma once
// The guard's own range: from the lit area of the target in an image. It uses neither the shape nor the attitude of the
// target, only the square root of its mean silhouette area, which its attitude changes by a tenth, and the share of it
// that the Sun lights at a phase angle, as of a sphere: (1 + cos(phase)) / 2.

#include <optional>

#include "fsw/core/types.h"
#include "fsw/imaging/image.h"

namespace vbar::fsw::guard {

/// A camera, as far as the guard needs it.
struct GuardCamera {
  double focal_length_px = 0.0;
  double dark_level_dn = 0.0;  ///< of a pixel without light
  double noise_dn = 0.0;       ///< of such a pixel, 1 sigma
};

/// Where the light comes from, and from where the target is seen: unit vectors in one frame.
struct Illumination {
  Vector3 line_of_sight = Vector3::UnitZ();  ///< from the servicer to the target
  Vector3 to_sun = Vector3::UnitX();
};

/// Lit pixels of an image, and whether they touch its rim. None if the brightest are hardly brighter than the noise, as
/// in penumbra.
struct LitArea {
  int pixels = 0;
  bool is_cut = false;
};

/// Pixels brighter than a twelfth of the brightest ones, so that neither exposure nor penumbra matters: white and dark
/// surfaces of a target differ by about that factor.
LitArea lit_area(const imaging::ImageView& image, const GuardCamera& camera);

/// Range, m. Empty for fewer lit pixels than a shape needs, a target cut by the rim, or a phase angle beyond 90 deg,
/// where the lit part is a crescent or nothing.
std::optional<double> range_from_size(const LitArea& area, const GuardCamera& camera, const Illumination& illumination,
                                      double target_size_m);

}  // namespace vbar::fsw::guard
