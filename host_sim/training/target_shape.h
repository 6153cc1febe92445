#pragma once
// The keypoints of the target that training labels.

#include <filesystem>

#include "fsw/pose/keypoint.h"

namespace vbar::training {

/// Tango's eleven keypoints (published with the SPEED and SPEED+ data sets: Sharma and D'Amico 2019, Park et al. 2022)
/// in the frame of its CAD file, m.
[[nodiscard]] fsw::pose::KeypointShape published_keypoints();

/// The target in body axes, everything from the centre of mass, m.
struct TargetShape {
  fsw::pose::KeypointShape keypoints;
  fsw::Vector3 model_origin = fsw::Vector3::Zero();  ///< of the CAD file
  double radius_m = 0.0;                             ///< of the farthest keypoint

  /// Of Tango; throws mission::MissionError if data_directory/bodies/tango.toml cannot be read.
  static TargetShape load(const std::filesystem::path& data_directory);
};

}  // namespace vbar::training
