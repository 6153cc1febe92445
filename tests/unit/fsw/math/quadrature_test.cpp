// Gauss-Legendre quadrature: what the rule is exact for.

#include "fsw/math/quadrature.h"

#include <cmath>

#include <gtest/gtest.h>

namespace vbar::fsw::math {
namespace {

TEST(GaussLegendre, IsExactForPolynomialsOfDegree63) {
  for (int degree = 0; degree <= 63; ++degree) {
    const double integral = integrate([degree](double x) { return std::pow(x, degree); }, -1.0, 1.0);
    const double expected = degree % 2 == 0 ? 2.0 / (degree + 1) : 0.0;
    EXPECT_NEAR(integral, expected, 1e-15) << "degree " << degree;  // rounding of 32 terms that sum to at most 2
  }
}

TEST(GaussLegendre, ScalesToAnyInterval) {
  EXPECT_NEAR(integrate([](double x) { return std::exp(x); }, -2.0, 5.0), std::exp(5.0) - std::exp(-2.0), 1e-13);
  EXPECT_NEAR(integrate([](double x) { return 1.0 / (1.0 + x * x); }, 0.0, 1.0), std::atan(1.0), 1e-15);
  EXPECT_EQ(integrate([](double) { return 1.0; }, 3.0, 3.0), 0.0);
  EXPECT_NEAR(integrate([](double x) { return x; }, 2.0, 0.0), -2.0, 1e-15);  // reversed
}

}  // namespace
}  // namespace vbar::fsw::math
