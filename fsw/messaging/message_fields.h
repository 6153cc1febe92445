#pragma once
// Encoding and decoding of vectors, matrices and rotations in the fields of packets.

#include "fsw/core/types.h"

namespace vbar::fsw::messaging {

// NOLINTBEGIN(cppcoreguidelines-avoid-c-arrays): fields of packet types

inline Vector3 vector(const double (&xyz)[3]) {
  return {xyz[0], xyz[1], xyz[2]};
}

inline Vector6 vector(const double (&six)[6]) {
  Vector6 v;
  for (int k = 0; k < 6; ++k) v(k) = six[k];
  return v;
}

inline void copy(const Vector3& from, double (&to)[3]) {
  for (int k = 0; k < 3; ++k) to[k] = from(k);
}

inline void copy(const Vector6& from, double (&to)[6]) {
  for (int k = 0; k < 6; ++k) to[k] = from(k);
}

/// Copies the lower triangle of a symmetric matrix, by rows.
void copy_lower_triangle(const Matrix6& from, double (&to)[21]);

/// Writes the Hamilton quaternion w, x, y, z of a rotation matrix that transforms components (Shepperd 1978).
void copy_rotation(const Matrix3& R, double (&to)[4]);

/// Returns whether the length of the quaternion differs from one by less than a part in a thousand.
bool is_rotation(const double (&q)[4]);

/// Returns the rotation matrix of a Hamilton quaternion w, x, y, z of any length but zero: `q_a_b` transforms
/// components from b to a.
Matrix3 rotation(const double (&q)[4]);

// NOLINTEND(cppcoreguidelines-avoid-c-arrays)

// Ranges of the values of telecommands. A NaN is in none.

inline constexpr double kLongestExposure_s = 3600.0;

constexpr bool is_between(double x, double minimum, double maximum) {
  return x >= minimum && x <= maximum;
}

/// Positive, up to the maximum.
constexpr bool is_positive(double x, double maximum) {
  return x > 0.0 && x <= maximum;
}

}  // namespace vbar::fsw::messaging
