#pragma once
// The start of a fit: two constant transforms around a known chain, by hand-eye calibration. Apart from the poses by
// images (pose_estimation.h), since Eigen's decompositions of both together take a compiler a minute and 1.6 GB.

#include <vector>

#include <Eigen/Geometry>

namespace vbar::tron::calibrate {

/// Holds one pair of A_i X = Z B_i: A is seen, B is by the chain.
struct HandEyePair {
  Eigen::Isometry3d A, B;
};

struct HandEye {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity(), Z = Eigen::Isometry3d::Identity();
};

/// Solves for the rotations by the null space of [R_A (x) I, -I (x) R_B'], for the translations by least squares. Needs
/// three pairs with rotations about two axes at least; with fewer the result is arbitrary.
[[nodiscard]] HandEye solve_hand_eye(const std::vector<HandEyePair>& pairs);

}  // namespace vbar::tron::calibrate
