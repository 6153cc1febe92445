// Form factors of a rectangle against Gauss-Legendre quadrature and against a closed form of another kind.

#include "hil_drivers/tron/lights/form_factor.h"

#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace vbar::tron {
namespace {

using fsw::Vector3;

/// Rectangle in the plane z = 0 with its bright side up.
std::array<Vector3, 4> rectangle(double half_x, double half_y) {
  return {Vector3(-half_x, -half_y, 0), Vector3(half_x, -half_y, 0), Vector3(half_x, half_y, 0),
          Vector3(-half_x, half_y, 0)};
}

/// Ten points of Gauss and Legendre (Abramowitz and Stegun, table 25.4) in each of `parts` intervals of -h to h.
template <class Function>
double integrated(double h, int parts, Function function) {
  constexpr std::array<double, 5> kAt{0.148874338981631211, 0.433395394129247191, 0.679409568299024406,
                                      0.865063366688984511, 0.973906528517171720};
  constexpr std::array<double, 5> kWeight{0.295524224714752870, 0.269266719309996355, 0.219086362515982044,
                                          0.149451349150580593, 0.066671344308688138};
  double sum = 0.0;
  const double half = h / parts;
  for (int part = 0; part < parts; ++part) {
    const double middle = -h + (2 * part + 1) * half;
    for (std::size_t k = 0; k < kAt.size(); ++k)
      sum += kWeight[k] * half * (function(middle + half * kAt[k]) + function(middle - half * kAt[k]));
  }
  return sum;
}

double by_quadrature(const Vector3& point, const Vector3& normal, double half_x, double half_y) {
  return integrated(half_x, 16, [&](double x) {
    return integrated(half_y, 16, [&](double y) {
      const Vector3 way = Vector3(x, y, 0) - point;
      const double distance2 = way.squaredNorm();
      return std::max(0.0, normal.dot(way)) * -way.z() / (std::numbers::pi * distance2 * distance2);
    });
  });
}

TEST(FormFactor, AgreesWithQuadratureAboveTheHorizon) {
  std::mt19937 random(10);
  std::uniform_real_distribution<double> place(-2.0, 2.0), height(0.4, 3.0);
  std::normal_distribution<double> normal;
  int compared = 0;
  while (compared < 200) {
    const Vector3 point(place(random), place(random), height(random));
    const Vector3 facing = Vector3(normal(random), normal(random), normal(random)).normalized();
    const auto corners = rectangle(0.3, 0.2);
    bool is_above = true;
    for (const Vector3& corner : corners) is_above = is_above && facing.dot(corner - point) > 0.0;
    if (!is_above) continue;
    ++compared;
    EXPECT_NEAR(form_factor(point, facing, corners), by_quadrature(point, facing, 0.3, 0.2), 1e-12);
  }
}

// The horizon cuts the rectangle along a line of x: quadrature over the part above it, to the line.
TEST(FormFactor, CountsThePartAboveTheHorizonOnly) {
  const Vector3 point(0.1, 0.05, 0.5);
  for (const double cut : {-0.2, -0.05, 0.0, 0.15, 0.29}) {
    // Horizon through the point and the line x = cut of the rectangle.
    const Vector3 along = Vector3(cut, 0, 0) - Vector3(point.x(), 0, point.z());
    Vector3 facing = Vector3::UnitY().cross(along).normalized();
    if (facing.x() < 0) facing = -facing;
    const double half = 0.5 * (0.3 - cut);
    const Vector3 shifted = point - Vector3(cut + half, 0, 0);
    EXPECT_NEAR(form_factor(point, facing, rectangle(0.3, 0.2)), by_quadrature(shifted, facing, half, 0.2), 1e-12)
        << cut;
    EXPECT_NEAR(form_factor(point, facing, rectangle(0.3, 0.2)) + form_factor(point, -facing, rectangle(0.3, 0.2)),
                by_quadrature(point, facing, 0.3, 0.2) + by_quadrature(point, -facing, 0.3, 0.2), 1e-3);
  }
}

// Howell, catalogue of configuration factors, B-3 (rectangle parallel to the element, a corner above it): four of a
// quarter each.
TEST(FormFactor, OfAParallelRectangleIsThatOfTheCatalogue) {
  const double a = 0.3, b = 0.2, c = 0.7;
  const double X = a / c, Y = b / c;
  const double quarter = (X / std::sqrt(1 + X * X) * std::atan(Y / std::sqrt(1 + X * X)) +
                          Y / std::sqrt(1 + Y * Y) * std::atan(X / std::sqrt(1 + Y * Y))) /
                         (2 * std::numbers::pi);
  EXPECT_NEAR(form_factor({0, 0, c}, -Vector3::UnitZ(), rectangle(a, b)), 4 * quarter, 1e-15);
}

TEST(FormFactor, OfAnEndlessPlaneIsOne) {
  EXPECT_NEAR(form_factor({0, 0, 1}, -Vector3::UnitZ(), rectangle(1e6, 1e6)), 1.0, 1e-9);
  EXPECT_NEAR(form_factor({0, 0, 1}, Vector3::UnitX(), rectangle(1e6, 1e6)), 0.5, 1e-6);
}

TEST(FormFactor, IsZeroBehindBelowAndInThePlane) {
  const auto corners = rectangle(0.3, 0.2);
  EXPECT_EQ(form_factor({0, 0, -1}, Vector3::UnitZ(), corners), 0.0);  // its back
  EXPECT_EQ(form_factor({0, 0, 1}, Vector3::UnitZ(), corners), 0.0);   // turned away
  EXPECT_EQ(form_factor({1, 0, 0}, -Vector3::UnitX(), corners), 0.0);  // in its plane
  EXPECT_EQ(form_factor({0, 0, 1}, -Vector3::UnitZ(), {}), 0.0);
}

}  // namespace
}  // namespace vbar::tron
