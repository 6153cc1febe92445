#pragma once
// The start of a fit: two constant transforms around a known chain.

#include <vector>

#include <Eigen/Geometry>

namespace vbar::tron::calibrate {

/// A_i X = Z B_i: what is seen and what the chain says.
struct HandEyePair {
  Eigen::Isometry3d A, B;
};

struct HandEye {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity(), Z = Eigen::Isometry3d::Identity();
};

/// Rotations from the null space of [R_A (x) I, -I (x) R_B'], translations by least squares. Needs three pairs with
/// rotations about two axes at least; with fewer the result is arbitrary.
[[nodiscard]] HandEye solve_hand_eye(const std::vector<HandEyePair>& pairs);

}  // namespace vbar::tron::calibrate
