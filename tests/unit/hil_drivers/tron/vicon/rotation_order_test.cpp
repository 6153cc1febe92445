// Orders of angles against rotations about fixed axes, written out as matrices.

#include "hil_drivers/tron/vicon/rotation_order.h"

#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

namespace vbar::tron::vicon {
namespace {

using fsw::Matrix3;

Matrix3 about(char axis, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  Matrix3 rotation;
  switch (axis) {
    case 'x':
      rotation << 1, 0, 0, 0, c, -s, 0, s, c;
      break;
    case 'y':
      rotation << c, 0, s, 0, 1, 0, -s, 0, c;
      break;
    default:
      rotation << c, -s, 0, s, c, 0, 0, 0, 1;
      break;
  }
  return rotation;
}

TEST(RotationOrder, IsTheOrderOfTheMatrices) {
  const std::array<double, 3> angles{0.3, -0.8, 1.9};
  for (const auto order : kRotationOrders) {
    Matrix3 expected = Matrix3::Identity();
    for (const char axis : order) expected = expected * about(axis, angles[static_cast<std::size_t>(axis - 'x')]);
    EXPECT_LT((rotation_of(angles, order) - expected).norm(), 1e-15) << order;
  }
}

// A rounding of an angle near the singular attitude is as large as the square root of the machine's; the matrices are
// compared, which it does not change.
TEST(RotationOrder, IsInvertedForEveryAttitude) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> angle(-std::numbers::pi, std::numbers::pi);
  for (const auto order : kRotationOrders)
    for (int trial = 0; trial < 1000; ++trial) {
      std::array<double, 3> angles{angle(random), angle(random), angle(random)};
      if (trial % 10 == 0) angles[static_cast<std::size_t>(order[1] - 'x')] = std::numbers::pi / 2;  // singular
      const Matrix3 rotation = rotation_of(angles, order);
      EXPECT_LT((rotation_of(angles_of(rotation, order), order) - rotation).norm(), 1e-12) << order;
    }
}

TEST(RotationOrder, OtherOrdersAreRefused) {
  for (const char* order : {"", "xy", "xyx", "XYZ", "xyzz"})
    EXPECT_THROW((void)rotation_of({}, order), std::invalid_argument);
}

}  // namespace
}  // namespace vbar::tron::vicon
