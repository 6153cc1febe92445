#pragma once
// The keypoints of the target that training labels.

#include <filesystem>
#include <string>

#include "fsw/pose/keypoint.h"

namespace vbar::training {

/// The target in body axes, everything from the centre of mass, m.
struct TargetShape {
  fsw::pose::KeypointShape keypoints;
  fsw::Vector3 model_origin = fsw::Vector3::Zero();  ///< origin of the CAD file
  double radius_m = 0.0;                             ///< distance of the farthest keypoint

  /// Loads the target whose body file has this name; throws mission::MissionError.
  static TargetShape load(const std::filesystem::path& data_directory, const std::string& target);
};

}  // namespace vbar::training
