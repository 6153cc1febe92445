#pragma once
// Where both arms and the carriage stand.

#include <Eigen/Core>

namespace vbar::tron {

using Joints = Eigen::Matrix<double, 6, 1>;  ///< A1..A6, rad

struct Posture {
  Joints camera_rad = Joints::Zero(), target_rad = Joints::Zero();
  double carriage_m = 0.0;  ///< along L x
};

}  // namespace vbar::tron
