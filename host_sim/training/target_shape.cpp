#include "host_sim/training/target_shape.h"

#include <algorithm>
#include <vector>

#include "host_sim/mission/body_file.h"

namespace vbar::training {

TargetShape TargetShape::load(const std::filesystem::path& data_directory, const std::string& target) {
  const std::filesystem::path file = mission::body_file_of(data_directory, target);
  const fsw::Vector3 centre_of_mass = mission::load_body(file).centre_of_mass_m;
  const std::vector<fsw::Vector3> from_origin = mission::load_keypoints(file, fsw::network::kKeypoints);
  TargetShape shape;
  std::copy(from_origin.begin(), from_origin.end(), shape.keypoints.begin());
  shape.model_origin = -centre_of_mass;
  for (fsw::Vector3& keypoint : shape.keypoints) {
    keypoint -= centre_of_mass;
    shape.radius_m = std::max(shape.radius_m, keypoint.norm());
  }
  return shape;
}

}  // namespace vbar::training
