#pragma once
// Whether a camera that gives bearings as long as the target is a point resolves it: its keypoints are used from the
// range on at which the network has enough pixels, to the range at which the target fills the image.

#include <optional>

#include "fsw/core/result.h"
#include "fsw/core/types.h"
#include "fsw/filter/relative_navigation_filter.h"
#include "fsw/measurements/keypoints/keypoint_settings.h"

namespace vbar::fsw::measurements {

enum class Resolution : std::uint8_t {
  kUnknown,  ///< no range: an image may show anything
  kTooSmall,
  kResolved,
  kTooLarge,
};

struct ResolutionLimits {
  double start_scale = 0.6;  ///< pixels of the camera per sample of the network: above it the target is resolved,
  double stop_scale = 0.45;  ///< below it no longer
  /// 3 sigma across the line of sight over the side of the crop, at most.
  double start_lateral_share = 0.15;
};

/// Pixels of the camera per sample of the network, of a target at `range_m`.
[[nodiscard]] double image_scale(const KeypointCameraSettings& camera, double range_m);

/// Factor on the lasting error of the target's apparent size (KeypointErrorSettings), at least 1. Measured over
/// a flight from 110 m to 6 m: the median error of the range of single poses is 2 % at a scale of 0.8, 0.6 % at 1
/// to 1.5, and 0.2 % from 2 on.
[[nodiscard]] double lasting_stretch_scale(double image_scale);

/// The resolution after `before`, with hysteresis.
[[nodiscard]] Resolution resolution_of(const KeypointCameraSettings& camera,
                                       const filter::RelativeNavigationFilter& filter, Resolution before,
                                       const ResolutionLimits& limits = {});

/// Decides what a camera with two exposures takes next of a target that it resolves: keypoints, as long as they aid, or
/// poses are being collected for an attitude. Otherwise every other image is for bearings, which a distant target still
/// has.
class ExposureScheduler {
 public:
  /// An image for keypoints of this scale (empty: unknown); `serves`: they aid, or an attitude is about to begin.
  void take_keypoints(std::optional<double> scale, bool serves) {
    is_bearing_due_ = !serves && scale && *scale < kLargestBearingScale;
  }
  void take_bearing() { is_bearing_due_ = false; }
  [[nodiscard]] bool is_bearing_due() const { return is_bearing_due_; }

  /// Beyond, the light of the target covers the stars beside it.
  static constexpr double kLargestBearingScale = 1.0;

 private:
  bool is_bearing_due_ = false;
};

}  // namespace vbar::fsw::measurements
