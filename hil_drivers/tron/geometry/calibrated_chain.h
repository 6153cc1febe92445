#pragma once
// The kinematic chain of an arm with the errors that calibration finds, for any scalar: numbers for the driver, numbers
// with derivatives for the fit. See ArmDesign (testbed_design.h) for the chain as designed.

#include <cmath>

#include <Eigen/Geometry>

#include "hil_drivers/tron/geometry/testbed_design.h"

namespace vbar::tron {

template <typename T>
using Rigid = Eigen::Transform<T, 3, Eigen::Isometry>;

inline constexpr int kLinkErrors = 5;  ///< after each of A1..A5
inline constexpr int kFlexes = 2;      ///< A2 and A3 bend
inline constexpr int kTrackErrors = 5;

/// Holds the lengths of an arm as designed, m; the names are those of ArmDesign.
struct ArmLengths {
  double d1_m = 0.0, a1_m = 0.0, a2_m = 0.0, a3_m = 0.0, d4_m = 0.0, d6_m = 0.0;
  static ArmLengths of(const ArmDesign& design) {
    return {design.d1_m, design.a1_m, design.a2_m, design.a3_m, design.d4_m, design.d6_m};
  }
};

/// Returns the rotation by a rotation vector, rad; smooth at zero.
template <typename T>
Eigen::Matrix<T, 3, 3> rotation_of(const Eigen::Matrix<T, 3, 1>& vector) {
  using std::cos, std::sin, std::sqrt;
  const T square = vector.squaredNorm();
  T a, b;  // sin x / x and (1 - cos x) / x^2
  if (square < T(1e-8)) {
    a = T(1.0) - square / T(6.0);
    b = T(0.5) - square / T(24.0);
  } else {
    const T angle = sqrt(square);
    a = sin(angle) / angle;
    b = (T(1.0) - cos(angle)) / square;
  }
  Eigen::Matrix<T, 3, 3> cross;
  cross << T(0.0), -vector.z(), vector.y(), vector.z(), T(0.0), -vector.x(), -vector.y(), vector.x(), T(0.0);
  return Eigen::Matrix<T, 3, 3>::Identity() + a * cross + b * cross * cross;
}

/// Returns the transform of six numbers: rotation vector, rad, then translation, m.
template <typename T>
Rigid<T> rigid_of(const T* six) {
  Rigid<T> result = Rigid<T>::Identity();
  result.linear() = rotation_of<T>(Eigen::Matrix<T, 3, 1>(six[0], six[1], six[2]));
  result.translation() = Eigen::Matrix<T, 3, 1>(six[3], six[4], six[5]);
  return result;
}

template <typename T>
void rotate(Rigid<T>& chain, const T& angle, const Eigen::Vector3d& axis) {
  const Eigen::Matrix<T, 3, 1> vector = axis.cast<T>() * angle;
  chain.linear() = (chain.linear() * rotation_of<T>(vector)).eval();
}

template <typename T>
void shift(Rigid<T>& chain, double x, double z) {
  chain.translation() += chain.linear() * Eigen::Matrix<T, 3, 1>(T(x), T(0.0), T(z));
}

/// Holds the parameters of one arm: joint offsets (6, rad), errors after A1..A5 (6 each: rad, m), flexes of A2 and A3
/// (rad per m of horizontal lever).
template <typename T>
struct ArmErrors {
  const T* offset_rad;
  const T* link;
  const T* flex_rad_m;
};

/// Returns T_base_flange at the joint angles that the controller states. `gravity`: +1 of an arm that stands on the
/// floor, -1 of one that hangs. The lever of A2 and A3 is the horizontal distance of the wrist from the joint; an arm
/// that stands turns forward under its weight (about +y), one that hangs turns back.
template <typename T>
Rigid<T> T_base_flange(const ArmLengths& arm, const double* joints_rad, double gravity, const ArmErrors<T>& errors) {
  using std::cos, std::sin;
  T q[kJoints];
  for (std::size_t k = 0; k < kJoints; ++k) q[k] = T(joints_rad[k]) + errors.offset_rad[k];
  const T upper = q[1], fore = q[1] + q[2];
  const T lever3 = T(arm.d4_m) * cos(fore) + T(arm.a3_m) * sin(fore);
  const T lever2 = T(arm.a2_m) * cos(upper) + lever3;
  q[1] += T(gravity) * errors.flex_rad_m[0] * lever2;
  q[2] += T(gravity) * errors.flex_rad_m[1] * lever3;

  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(), z = Eigen::Vector3d::UnitZ();
  Rigid<T> chain = Rigid<T>::Identity();
  shift(chain, 0.0, arm.d1_m);
  rotate(chain, q[0], Eigen::Vector3d(-z));
  chain = chain * rigid_of(errors.link);
  shift(chain, arm.a1_m, 0.0);
  rotate(chain, q[1], y);
  chain = chain * rigid_of(errors.link + 6);
  shift(chain, arm.a2_m, 0.0);
  rotate(chain, q[2], y);
  chain = chain * rigid_of(errors.link + 12);
  shift(chain, 0.0, arm.a3_m);
  rotate(chain, q[3], Eigen::Vector3d(-x));
  chain = chain * rigid_of(errors.link + 18);
  shift(chain, arm.d4_m, 0.0);
  rotate(chain, q[4], y);
  chain = chain * rigid_of(errors.link + 24);
  rotate(chain, q[5], Eigen::Vector3d(-x));
  shift(chain, arm.d6_m, 0.0);
  Eigen::Matrix<T, 3, 3> R_wrist_flange;
  R_wrist_flange << T(0.0), T(0.0), T(1.0), T(0.0), T(1.0), T(0.0), T(-1.0), T(0.0), T(0.0);
  chain.linear() = (chain.linear() * R_wrist_flange).eval();
  return chain;
}

/// Holds the places of the control points of the track's errors: uniform cubic B-splines.
struct TrackGrid {
  double first_m = 0.0;  ///< carriage place of the first control point
  double step_m = 1.0;
  double middle_m = 4.0;  ///< where the scale error is zero
  double plate_m = 0.0;   ///< height of the plate by which the arm hangs: the errors of rotation turn about it
};

/// Returns T_L_carriage: translation along x by the carriage, its scale error and the five errors of the track: roll,
/// pitch, yaw, rad, sideways, height, m. `knots`: five numbers a control point.
template <typename T>
Rigid<T> T_L_carriage(const TrackGrid& grid, double carriage_m, const T* knots, int count, const T& scale) {
  const double place = (carriage_m - grid.first_m) / grid.step_m;
  const double cell = std::min(std::max(std::floor(place), 1.0), static_cast<double>(count - 3));
  const double u = place - cell;
  const double v = 1.0 - u;
  const double weights[4] = {v * v * v / 6.0, (3.0 * u * u * u - 6.0 * u * u + 4.0) / 6.0,
                             (3.0 * v * v * v - 6.0 * v * v + 4.0) / 6.0, u * u * u / 6.0};
  T errors[kTrackErrors];
  for (int e = 0; e < kTrackErrors; ++e) {
    errors[e] = T(0.0);
    for (int k = 0; k < 4; ++k) errors[e] += T(weights[k]) * knots[(static_cast<int>(cell) - 1 + k) * kTrackErrors + e];
  }
  const T six[6] = {errors[0], errors[1], errors[2], T(carriage_m) + scale * T(carriage_m - grid.middle_m),
                    errors[3], errors[4]};
  Rigid<T> carriage = rigid_of(six);
  const Eigen::Matrix<T, 3, 1> plate(T(0.0), T(0.0), T(grid.plate_m));
  carriage.translation() += plate - carriage.linear() * plate;
  return carriage;
}

}  // namespace vbar::tron
