#include "host_sim/truth/atmosphere/clamped_spline.h"

#include <gtest/gtest.h>

namespace vbar::truth {
namespace {

TEST(ClampedSpline, ReproducesACubicAndItsIntegral) {
  // A clamped cubic spline through points of a cubic, with its slopes at the ends, is that cubic.
  const auto f = [](double x) { return 2.0 + x * (-1.0 + x * (0.5 + 3.0 * x)); };
  const auto slope = [](double x) { return -1.0 + x * (1.0 + 9.0 * x); };
  const auto integral = [](double x) { return x * (2.0 + x * (-0.5 + x * (0.5 / 3.0 + 0.75 * x))); };
  const std::array<double, 5> x{0.0, 0.3, 0.4, 0.8, 1.0};
  std::array<double, 5> y{};
  for (std::size_t i = 0; i < x.size(); ++i) y[i] = f(x[i]);
  const ClampedSpline<5> spline(x, y, slope(0.0), slope(1.0));
  for (int i = 0; i <= 20; ++i) {
    const double t = 0.05 * i;
    EXPECT_NEAR(spline.value(t), f(t), 1e-14);  // rounding of numbers about 1
    EXPECT_NEAR(spline.integral(t), integral(t), 1e-14);
  }
}

}  // namespace
}  // namespace vbar::truth
