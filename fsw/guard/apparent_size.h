#pragma once
// Range of the safety monitor, from the lit area of the target in an image. It uses neither the shape nor the attitude
// of the target: the square root of the mean silhouette area, which the attitude changes by a tenth, and the share that
// the Sun lights at a phase angle, as on a sphere: (1 + cos(phase)) / 2.

#include <optional>

#include "fsw/core/types.h"
#include "fsw/imaging/image.h"

namespace vbar::fsw::guard {

/// Holds the parameters of a camera that the safety monitor needs.
struct GuardCamera {
  double focal_length_px = 0.0;
  double dark_level_dn = 0.0;  ///< level of a pixel without light
  double noise_dn = 0.0;       ///< noise of such a pixel, 1 sigma
};

/// Holds the directions of light and line of sight: unit vectors in one frame.
struct Illumination {
  Vector3 line_of_sight = Vector3::UnitZ();  ///< from the servicer to the target
  Vector3 to_sun = Vector3::UnitX();
};

/// Counts the lit pixels of an image, and states whether they touch its rim. The count is 0 if the brightest pixels are
/// hardly brighter than the noise, as in penumbra.
struct LitArea {
  int pixels = 0;
  bool is_cut = false;
};

/// Counts the pixels brighter than a twelfth of the brightest ones, so that neither exposure nor penumbra has an
/// effect: white and dark surfaces of a target differ by about that factor.
LitArea lit_area(const imaging::ImageView& image, const GuardCamera& camera);

/// Returns the range, m. Returns nothing for fewer lit pixels than a shape needs, a target cut by the rim, or a phase
/// angle beyond 90 deg, where at most a crescent is lit.
std::optional<double> range_from_size(const LitArea& area, const GuardCamera& camera, const Illumination& illumination,
                                      double target_size_m);

}  // namespace vbar::fsw::guard
