#pragma once
// The background of an image of the testbed, replaced by what a camera in orbit would see: nothing but its own noise.
// The outline is that of the CAD model where the target is held to be. What hides the target stays in the image. A lit
// wall in the pixels along the outline would make the target seem larger: with a rim of 4 px of it, the pose network
// measures the range 3 % too short. So the rim is narrow, and the share of the wall in its pixels is subtracted.

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "host_sim/twins/camera/camera_settings.h"
#include "host_sim/twins/camera/model/silhouette.h"
#include "host_sim/twins/camera/projection.h"

namespace vbar::tron {

/// Describes a dark image: median, and the standard deviation of the middle two thirds as of a normal distribution.
struct DarkLevel {
  double offset_dn = 0.0;
  double noise_dn = 0.0;
};

/// Throws std::invalid_argument for fewer than 100 pixels.
[[nodiscard]] DarkLevel dark_level(std::span<const std::uint16_t> dn);

/// Returns 1 for each pixel within `radius_px` of which anything is covered, rows of `width`.
[[nodiscard]] std::vector<std::uint8_t> grown(std::span<const float> covered, int width, int radius_px);

/// Describes where the target is in an image, in rows of `width`.
struct Outline {
  static constexpr int kMargin_px = 1;  ///< margin for blur and for the error of the measured pose

  int width = 0;
  std::vector<float> covered;      ///< fraction of a pixel's light that is the target's
  std::vector<std::uint8_t> mask;  ///< 1: of the target or of the margin around it
};

/// Returns the outline of the body at pose `T_C_B`: full scale, in camera axes. Blurs what is covered by a Gaussian of
/// 0.7 px, about that of lens and pixel.
[[nodiscard]] Outline outline_of(twins::camera::Silhouette& silhouette, const twins::camera::Projection& lens,
                                 const Eigen::Isometry3d& T_C_B, const twins::camera::Region& region);

/// Subtracts from each pixel of the margin the light that is not the target's: the uncovered fraction times the mean
/// of the background near it.
void subtract_background(const Outline& outline, const DarkLevel& dark, std::span<std::uint16_t> dn);

/// Replaces the pixels where `mask` is 0. The noise is a pure function of (key, image, pixel).
void replace_background(std::span<const std::uint8_t> mask, const DarkLevel& dark, std::uint64_t key,
                        std::int64_t image, std::uint16_t full_scale_dn, std::span<std::uint16_t> dn);

}  // namespace vbar::tron
