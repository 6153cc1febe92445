#pragma once
// A keypoint of the target as seen in an image.

#include <array>

#include "fsw/core/types.h"
#include "fsw/vision/pose/keypoint_network.h"

namespace vbar::fsw::pose {

struct Keypoint {
  Vector2 pixel = Vector2::Zero();  ///< on the detector, distorted as it was seen; an integer is the centre of a pixel
  Matrix2 covariance_px2 = Matrix2::Identity();
  double peak = 0.0;       ///< share of the heatmap's probability in its highest 3 x 3 cells, 0 to 1
  bool is_usable = false;  ///< one clear peak, not at the heatmap's edge
};

using Keypoints = std::array<Keypoint, pose::kKeypoints>;

/// Positions of the keypoints on the target: body axes, from its centre of mass, m.
using KeypointShape = std::array<Vector3, pose::kKeypoints>;

}  // namespace vbar::fsw::pose
