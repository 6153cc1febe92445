#include "host_sim/training/target_shape.h"

#include <algorithm>
#include <vector>

#include "host_sim/mission/body_file.h"

namespace vbar::training {

TargetShape TargetShape::load(const std::filesystem::path& data_directory) {
  const fsw::Vector3 centre_of_mass = mission::load_body(data_directory / "bodies" / "tango.toml").centre_of_mass_m;
  const std::vector<fsw::Vector3> published =
      mission::load_keypoints(data_directory / "models" / "tango_keypoints.toml", fsw::network::kKeypoints);
  TargetShape shape;
  std::copy(published.begin(), published.end(), shape.keypoints.begin());
  shape.model_origin = -centre_of_mass;
  for (fsw::Vector3& keypoint : shape.keypoints) {
    keypoint -= centre_of_mass;
    shape.radius_m = std::max(shape.radius_m, keypoint.norm());
  }
  return shape;
}

}  // namespace vbar::training
