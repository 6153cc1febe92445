// The control matrix against what impulses really do to a Keplerian orbit.

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "fsw/orbit/roe.h"
#include "fsw/orbit/rtn.h"
#include "tests/support/figures.h"
#include "tests/unit/fsw/orbit/mission.h"

namespace vbar::fsw::orbit {
namespace {

/// ROE that an impulse of the deputy (its RTN) creates from zero.
Vector6 roe_of_impulse(const QnsElements& orbit, const Vector3& dv_rtn) {
  const CartesianState after = apply_impulse_rtn(cartesian_from_qns(orbit).value(), dv_rtn);
  return roe_from_qns(orbit, qns_from_cartesian(after).value());
}

TEST(ControlMatrix, IsTheDerivativeOfTheOrbitAfterAnImpulse) {
  std::mt19937_64 generator(5);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  constexpr double kStep = 0.05;  // m/s
  for (int k = 0; k < 2000; ++k) {
    const double e = 0.7 * unit(generator);
    const double w = 6.2 * unit(generator);
    const QnsElements orbit{.a = 6.8e6 + 2e7 * unit(generator),
                            .ex = e * std::cos(w),
                            .ey = e * std::sin(w),
                            .i = 0.2 + 2.7 * unit(generator),
                            .raan = 1.0,
                            .u = 6.2 * unit(generator) - 3.1};
    const Matrix63 gamma = roe_control_matrix(orbit);
    const double scale = 1.0 / (mean_motion(orbit.a) * orbit.a);
    for (int axis = 0; axis < 3; ++axis) {
      const Vector3 dv = kStep * Vector3::Unit(axis);
      const Vector6 slope = (roe_of_impulse(orbit, dv) - roe_of_impulse(orbit, -dv)) / (2.0 * kStep);
      for (int row = 0; row < 6; ++row) {
        // Central difference: (dv/v)^2 of 1e-10 truncation, times 1/(1-e)^3 = 40 near the apsides, and 1e-15/0.05 of
        // rounding.
        ASSERT_NEAR(slope(row), gamma(row, axis), 5e-8 * scale) << "row " << row << ", axis " << axis << ", e = " << e;
      }
    }
  }
}

TEST(ControlMatrix, AServicerBurnChangesTheMissionsRoeByMinusTheMatrix) {
  // Exact two-body effect of 1 m/s along each axis of the servicer on a * ROE of the target, from an independent
  // program, printed to 1 mm; a is the servicer's before the burn.
  const QnsElements before = mission::kServicerOsculating;
  const CartesianState servicer = cartesian_from_qns(before).value();
  const double expected[3][6] = {{-0.092, 1887.963, 11.415, 944.975, 0.0, 0.0},
                                 {-1893.052, 0.017, -1890.075, 22.814, 0.0, 0.0},
                                 {-0.126, -0.001, -0.126, 0.004, -943.559, 11.398}};
  for (int axis = 0; axis < 3; ++axis) {
    const CartesianState after = apply_impulse_rtn(servicer, Vector3::Unit(axis));
    const QnsElements chief = qns_from_cartesian(after).value();
    const Vector6 a_roe = before.a * roe_from_qns(chief, before);
    const Vector6 linear = -before.a * roe_control_matrix(before) * Vector3::Unit(axis);
    for (int row = 0; row < 6; ++row) {
      EXPECT_NEAR(a_roe(row), expected[axis][row], 6e-4)
          << "axis " << axis << ", row " << row;  // half of the last digit
      EXPECT_NEAR(linear(row), expected[axis][row], 0.6)
          << "axis " << axis << ", row " << row;  // second order, dv/v = 1.3e-4
    }
  }
}

TEST(ControlMatrix, NearCircularFormDiffersByTheEccentricity) {
  const QnsElements orbit = mission::kServicerMean;
  const Matrix63 exact = roe_control_matrix(orbit);
  const Matrix63 circular = roe_control_matrix_near_circular(orbit);
  const double scale = 1.0 / (mean_motion(orbit.a) * orbit.a);
  const double e = std::hypot(orbit.ex, orbit.ey);
  // Largest coefficient of the first order: u instead of theta turns 2 cos u by 2 * 2e sin M, plus the e of k.
  EXPECT_LT(accuracy::largest_entry(exact - circular), 6.0 * e * scale);
  EXPECT_GT(accuracy::largest_entry(exact - circular), 0.5 * e * scale);
}

TEST(ControlMatrix, MissionScalesAreAKilometreAMetrePerSecond) {
  // Metres of a * ROE per m/s, to the oracle's printed digits.
  const QnsElements orbit = mission::kServicerMean;
  const Matrix63 gamma = orbit.a * roe_control_matrix_near_circular(orbit);
  EXPECT_NEAR(gamma(0, 1), 1886.43, 5e-3);
  EXPECT_NEAR(std::hypot(gamma(4, 2), gamma(5, 2)), 943.21, 5e-3);
}

TEST(ControlMatrix, IsNotANumberForWhatIsNoOrbit) {
  QnsElements orbit = mission::kServicerMean;
  orbit.ex = 1.5;
  EXPECT_TRUE(std::isnan(roe_control_matrix(orbit)(0, 0)));
}

}  // namespace
}  // namespace vbar::fsw::orbit
