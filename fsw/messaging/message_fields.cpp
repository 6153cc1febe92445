#include "fsw/messaging/message_fields.h"

#include "fsw/math/math.h"

namespace vbar::fsw::messaging {

// NOLINTBEGIN(cppcoreguidelines-avoid-c-arrays): fields of packet types
namespace {

double norm2(const double (&q)[4]) {
  return q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
}

}  // namespace

void copy_lower_triangle(const Matrix6& from, double (&to)[21]) {
  std::size_t place = 0;
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column <= row; ++column) to[place++] = from(row, column);
  }
}

/// Computes the largest of the four components first.
void copy_rotation(const Matrix3& R, double (&to)[4]) {
  const double trace = R.trace();
  int largest = 0;
  double maximum = trace;
  for (int k = 0; k < 3; ++k) {
    if (R(k, k) > maximum) {
      maximum = R(k, k);
      largest = k + 1;
    }
  }
  const double big = math::sqrt(1.0 + 2.0 * maximum - trace) * 0.5;
  const double by = 0.25 / big;
  if (largest == 0) {
    to[0] = big;
    to[1] = (R(2, 1) - R(1, 2)) * by;
    to[2] = (R(0, 2) - R(2, 0)) * by;
    to[3] = (R(1, 0) - R(0, 1)) * by;
    return;
  }
  const int i = largest - 1;
  const int j = (i + 1) % 3;
  const int k = (i + 2) % 3;
  to[0] = (R(k, j) - R(j, k)) * by;
  to[1 + i] = big;
  to[1 + j] = (R(j, i) + R(i, j)) * by;
  to[1 + k] = (R(k, i) + R(i, k)) * by;
}

bool is_rotation(const double (&q)[4]) {
  return math::abs(norm2(q) - 1.0) < 2e-3;
}

Matrix3 rotation(const double (&q)[4]) {
  const double w = q[0], x = q[1], y = q[2], z = q[3];
  const double s = 2.0 / norm2(q);
  Matrix3 R;
  R << 1.0 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y),  //
      s * (x * y + w * z), 1.0 - s * (x * x + z * z), s * (y * z - w * x),   //
      s * (x * z - w * y), s * (y * z + w * x), 1.0 - s * (x * x + y * y);
  return R;
}
// NOLINTEND(cppcoreguidelines-avoid-c-arrays)

}  // namespace vbar::fsw::messaging
