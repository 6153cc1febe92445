#pragma once
// From a frame of the testbed to the image that a camera in orbit would deliver, and what its light says of the lamps.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "fsw/core/types.h"
#include "host_sim/twins/camera/camera_settings.h"
#include "host_sim/twins/camera/model/cad_objects.h"
#include "host_sim/twins/camera/model/target_renderer.h"
#include "host_sim/twins/camera/optics.h"

namespace vbar::tron {

// Binning in the driver, for a camera that reads single pixels.

/// Returns means of 2 x 2 pixels, halves rounded up: the numbers of a camera that adds the charges of four pixels and
/// reads a full sum as it does a full pixel (twins/camera/binning.h). `dn`: rows of `width`; width and height are even.
/// Throws std::invalid_argument for another size.
[[nodiscard]] std::vector<std::uint16_t> binned_by_two(std::span<const std::uint16_t> dn, int width, int height);

// The background of an image of the testbed, replaced by what a camera in orbit would see: nothing but its own noise.
// The outline is that of the CAD model where the target is held to be. What hides the target stays in the image. A lit
// wall in the pixels along the outline would make the target seem larger: with a rim of 4 px of it, the pose network
// measures the range 3 % too short. So the rim is narrow, and the share of the wall in its pixels is subtracted.

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

// The light of the target in an image, against what its lamp and boxes should give: a lamp that is off is seen there
// only, because nothing acknowledges a lighting level.

/// Holds the light on a target in orbit.
struct TargetLight {
  fsw::Vector3 sun_C = fsw::Vector3::UnitZ();  ///< unit
  double sun_photons_per_m2_s = 0.0;           ///< that reach it
  fsw::Vector3 earth_C = fsw::Vector3::UnitZ();
  double earth_photons_per_m2_s = 0.0;
  double earth_half_angle = 1.1;  ///< rad
};

/// Predicts the light of the CAD model's surfaces towards the camera, which the mock-up's resemble.
class ExpectedLight {
 public:
  explicit ExpectedLight(const twins::camera::CadModel& model) : renderer_(model) {}

  /// Returns photo-electrons in an image of `camera`; `T_C_B`: body at full scale in camera axes.
  [[nodiscard]] double electrons(const Eigen::Isometry3d& T_C_B, const TargetLight& light,
                                 const twins::camera::CameraSettings& camera);

 private:
  twins::camera::TargetRenderer renderer_;
  std::vector<twins::camera::LightSample> samples_;
};

/// Returns photo-electrons of the pixels where `mask` is 1.
[[nodiscard]] double measured_electrons(std::span<const std::uint16_t> dn, std::span<const std::uint8_t> mask,
                                        double offset_dn, double gain_dn_per_electron);

struct FinishedImage {
  std::vector<std::uint16_t> dn;
  std::optional<double> light_level;  ///< light of the target, relative to the prediction; none if it is unlit
  /// What is left without the light predicted of the Earth, relative to the prediction of sunlight by the diffuse part
  /// of the surfaces: a glint depends on the gloss of the mock-up, a face that is not black does not. None where that
  /// prediction is faint.
  std::optional<double> sunlight_level;
};

class ImageFinish {
 public:
  /// Takes `camera` as calibrated, binned by two as the image. `dark`: a frame of single pixels without light. `key`:
  /// key of the noise.
  ImageFinish(const twins::camera::CameraSettings& camera, const twins::camera::CadModel& model,
              const std::vector<std::uint16_t>& dark, std::uint64_t key);

  /// Finishes `frame` of single pixels. `T_C_B`: body at full scale as measured.
  [[nodiscard]] FinishedImage finish(const std::vector<std::uint16_t>& frame, std::int64_t image,
                                     const Eigen::Isometry3d& T_C_B, const std::optional<TargetLight>& light);

  [[nodiscard]] const DarkLevel& dark() const { return dark_; }

 private:
  [[nodiscard]] std::vector<std::uint16_t> binned(const std::vector<std::uint16_t>& frame) const;

  twins::camera::CameraSettings camera_;
  twins::camera::Optics lens_;
  twins::camera::Silhouette silhouette_;
  ExpectedLight expected_, expected_diffuse_;
  DarkLevel dark_;
  std::uint64_t key_;
};

}  // namespace vbar::tron
