#pragma once
// Places of both arms and the carriage, and their motions.

#include <cmath>
#include <functional>

#include <Eigen/Core>

namespace vbar::tron {

using Joints = Eigen::Matrix<double, 6, 1>;  ///< A1..A6, rad

struct Posture {
  Joints camera_rad = Joints::Zero(), target_rad = Joints::Zero();
  double carriage_m = 0.0;  ///< along L x
};

[[nodiscard]] inline bool is_finite(const Posture& posture) {
  return posture.camera_rad.allFinite() && posture.target_rad.allFinite() && std::isfinite(posture.carriage_m);
}

/// Gives a posture of both arms and the carriage for every robot cycle.
struct Motion {
  int cycles = 0;                               ///< number of cycles; the last is at rest
  std::function<Posture(int cycle)> at;         ///< from 1
  std::function<Motion(int cycle)> stop_after;  ///< slows down along the same path, after that cycle
};

enum class MotionEnd {
  kArrived,
  kInterrupted,  ///< both arms are at rest, or stopped by their controllers: recover()
};

}  // namespace vbar::tron
