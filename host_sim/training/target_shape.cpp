#include "host_sim/training/target_shape.h"

#include <algorithm>

#include "host_sim/mission/body_file.h"

namespace vbar::training {

fsw::pose::KeypointShape published_keypoints() {
  using fsw::Vector3;
  return {Vector3(-0.37, -0.385, 0.3215),  Vector3(-0.37, 0.385, 0.3215), Vector3(0.37, 0.385, 0.3215),
          Vector3(0.37, -0.385, 0.3215),   Vector3(-0.37, -0.264, 0.0),   Vector3(-0.37, 0.304, 0.0),
          Vector3(0.37, 0.304, 0.0),       Vector3(0.37, -0.264, 0.0),    Vector3(-0.5427, 0.4877, 0.2535),
          Vector3(0.5427, 0.4877, 0.2591), Vector3(0.305, -0.579, 0.2515)};
}

TargetShape TargetShape::load(const std::filesystem::path& data_directory) {
  const fsw::Vector3 centre_of_mass = mission::load_body(data_directory / "bodies" / "tango.toml").centre_of_mass_m;
  TargetShape shape;
  shape.keypoints = published_keypoints();
  shape.model_origin = -centre_of_mass;
  for (fsw::Vector3& keypoint : shape.keypoints) {
    keypoint -= centre_of_mass;
    shape.radius_m = std::max(shape.radius_m, keypoint.norm());
  }
  return shape;
}

}  // namespace vbar::training
