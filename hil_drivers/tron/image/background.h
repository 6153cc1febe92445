#pragma once
// The background of an image of the testbed, replaced by what a camera in orbit would see: nothing but its own noise.
// The mask is the outline of the CAD model where the target is held to be. What hides the target, and what of the mount
// lies inside the margin, stays in the image.

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "host_sim/twins/camera/camera_settings.h"
#include "host_sim/twins/camera/model/silhouette.h"
#include "host_sim/twins/camera/projection.h"

namespace vbar::tron {

/// Of a dark image: median, and the standard deviation of the middle two thirds as of a normal distribution.
struct DarkLevel {
  double offset_dn = 0.0;
  double noise_dn = 0.0;
};

/// Throws std::invalid_argument for fewer than 100 pixels.
[[nodiscard]] DarkLevel dark_level(std::span<const std::uint16_t> dn);

/// 1 where a pixel that is covered by at least `least` lies within `radius_px`, rows of `width`.
[[nodiscard]] std::vector<std::uint8_t> grown(std::span<const float> covered, int width, int radius_px,
                                              float least = 0.01F);

/// The target's outline in an image, grown.
class TargetMask {
 public:
  static constexpr int kMargin_px = 4;

  explicit TargetMask(const twins::camera::CadModel& model) : silhouette_(model) {}

  /// `T_C_B`: body at full scale in camera axes. Rows of `region`.
  [[nodiscard]] std::vector<std::uint8_t> draw(const twins::camera::Projection& lens, const Eigen::Isometry3d& T_C_B,
                                               const twins::camera::Region& region);

 private:
  twins::camera::Silhouette silhouette_;
  std::vector<float> covered_;
};

/// Replaces the pixels where `mask` is 0. The noise is a pure function of (key, image, pixel).
void replace_background(std::span<const std::uint8_t> mask, const DarkLevel& dark, std::uint64_t key,
                        std::int64_t image, std::uint16_t full_scale_dn, std::span<std::uint16_t> dn);

}  // namespace vbar::tron
