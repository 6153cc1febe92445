// The J2 state-transition matrix of mean ROE and the secular rates behind it.

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "fsw/orbit/gravity_field.h"
#include "fsw/orbit/propagate.h"
#include "fsw/orbit/roe.h"
#include "fsw/orbit/rtn.h"
#include "tests/support/figures.h"
#include "tests/unit/fsw/orbit/mission.h"
#include "tests/unit/fsw/orbit/reference_orbit.h"

namespace vbar::fsw::orbit {

namespace {

constexpr double kDegree = mission::kDegree;

TEST(SecularRates, OfTheMissionOrbit) {
  const SecularRates rates = secular_rates(mission::kServicerMean);
  const double orbit = 5926.3815;              // s
  EXPECT_NEAR(rates.kappa, 6.9901e-7, 5e-12);  // here and below half a unit of the oracle's last digit
  EXPECT_NEAR(rates.perigee * orbit / kDegree, -0.2133, 5e-5);
  EXPECT_NEAR(math::kTwoPi / rates.mean_argument_of_latitude(), 5933.571, 5e-4);
  EXPECT_NEAR(rates.raan * 86400.0 / kDegree, 0.98534, 5e-6);  // PRISMA's dawn-dusk orbit, near 0.98565 deg/day
}

TEST(SecularRates, FollowKozaiForAnEccentricOrbit) {
  // Vallado, Fundamentals of Astrodynamics, eq. 9-38 to 9-41: -3/2 n J2 (Re/p)^2 cos i, 3/4 n J2 (Re/p)^2 (4 - 5 sin^2
  // i), n + 3/4 n J2 (Re/p)^2 eta (2 - 3 sin^2 i).
  const double e = 0.4;
  const double i = 0.9;
  const QnsElements q{.a = 1.2e7, .ex = e * std::cos(1.0), .ey = e * std::sin(1.0), .i = i, .raan = 0.0, .u = 0.0};
  const double n = std::sqrt(kMu / std::pow(q.a, 3));
  const double p = q.a * (1.0 - e * e);
  const double factor = 0.75 * n * kJ2 * std::pow(kEarthRadius / p, 2);
  const double s2 = std::pow(std::sin(i), 2);
  const SecularRates rates = secular_rates(q);
  EXPECT_NEAR(rates.raan, -2.0 * factor * std::cos(i), 1e-20);  // rounding of 1e-7 rad/s with a margin of 100
  EXPECT_NEAR(rates.perigee, factor * (4.0 - 5.0 * s2), 1e-20);
  EXPECT_NEAR(rates.mean_anomaly, n + factor * std::sqrt(1.0 - e * e) * (2.0 - 3.0 * s2), 1e-17);
}

TEST(SecularMotion, ComposesAndReverses) {
  const QnsElements start = mission::kServicerMean;
  const QnsElements once = propagate_secular(start, 30000.0);
  const QnsElements twice = propagate_secular(propagate_secular(start, 12000.0), 18000.0);
  const QnsElements back = propagate_secular(once, -30000.0);
  EXPECT_NEAR(once.u, twice.u, 1e-13);  // rounding of 32 rad
  EXPECT_NEAR(once.ex, twice.ex, 1e-17);
  EXPECT_NEAR(back.ey, start.ey, 1e-17);
  EXPECT_NEAR(back.u, start.u, 1e-14);
  EXPECT_GT(once.u, 30.0);  // u counts revolutions
}

TEST(Transition, OfTheMissionOverOneOrbit) {
  // Independent program, printed to ten digits; the mean elements it used are those of mission.h, printed to ten digits
  // too.
  const Matrix6 phi = roe_transition_j2(mission::kServicerMean, 5926.381515);
  const double relative = 1e-8;
  EXPECT_NEAR(phi(1, 0), -9.397543161, 9.4 * relative);
  EXPECT_NEAR(phi(1, 4), 8.173161879e-3, 8.2e-3 * relative);
  EXPECT_NEAR(phi(2, 2), 0.9999930708, 1e-10);
  EXPECT_NEAR(phi(2, 3), 3.722730330e-3, 3.7e-3 * relative);
  EXPECT_NEAR(phi(3, 2), -3.722746475e-3, 3.7e-3 * relative);
  EXPECT_NEAR(phi(3, 4), 6.079630e-6, 5e-13);
  EXPECT_NEAR(phi(5, 0), -4.086581889e-3, 4.1e-3 * relative);
  EXPECT_NEAR(phi(5, 4), 8.117269141e-3, 8.1e-3 * relative);
}

TEST(Transition, RatesOfTheMissionInPlainUnits) {
  const Matrix6 phi = roe_transition_j2(mission::kServicerMean, 3600.0);
  EXPECT_NEAR(1000.0 * phi(5, 4), 4.93, 5e-3);             // m of a diy an hour for 1 km of a dix
  EXPECT_NEAR(1000.0 * phi(1, 4), 4.96, 5e-3);             // m of a dl an hour for the same
  EXPECT_NEAR(phi(1, 0) / 3600.0, -1.58571e-3, 5e-9);      // m/s of a dl for 1 m of a da
  EXPECT_NEAR(-2000.0 * phi(1, 0) / 3600.0, 3.171, 5e-4);  // m/s: the paper's "3.2 m/s" at waypoint 0
}

struct PublishedCase {
  int orbits;
  QnsElements chief;
  double duration;
  double a_roe_start[6];
  double a_roe_end[6];      ///< by the transition matrix
  double a_roe_secular[6];  ///< by the nonlinear secular motion of both orbits
};

QnsElements from_keplerian(double a, double e, double i_deg, double raan_deg, double w_deg, double m_deg) {
  const double w = w_deg * kDegree;
  return {a, e * std::cos(w), e * std::sin(w), i_deg * kDegree, raan_deg * kDegree, w + m_deg * kDegree};
}

TEST(Transition, OfThePublishedTestOrbits) {
  // Orbits and initial ROE: Koenig, Guffanti and D'Amico 2017, table 2. Results: computed independently (complex-step
  // Jacobian of the secular motion) with the same constants.
  const PublishedCase cases[] = {
      {1,
       from_keplerian(6812e3, 0.005, 30, 60, 180, 180),
       5595.29436709261,
       {0, 0, 200, -200, 200, -200},
       {0.0, -5.462141730250013, 202.44463019696428, -197.50525687850646, 200.0, -199.53722103959004},
       {0.0, -5.461994422675819, 202.44451647519026, -197.50537458038218, 200.0, -199.5373009200097}},
      {10,
       from_keplerian(6812e3, 0.005, 30, 60, 180, 180),
       55952.94367092609,
       {0, 0, 200, -200, 200, -200},
       {0.0, -54.621417302500134, 223.00350793040832, -173.75562718023787, 200.0, -195.3722103959003},
       {0.0, -54.619944253891305, 223.00250820828543, -173.75692256536092, 200.0, -195.37300919792145}},
      {10,
       from_keplerian(8348e3, 0.2, 1, 120, 120, 180),
       75907.4917848662,
       {25, 4000, -1000, 1000, 1000, 0},
       {25.0, 1752.366036287689, -1141.19190935257, 847.002201794721, 1000.0, -1.1654433100675734},
       {25.0, 1752.4139491941019, -1141.2144619809806, 846.9775147145307, 1000.0, -1.1660547980206273}},
      {10,
       from_keplerian(13256e3, 0.5, 45, 80, 60, 180),
       151890.18944301733,
       {100, 5000, 5000, 5000, -5000, 20000},
       {100.0, -3423.506130673937, 4360.807969102074, 5411.900742901021, -5000.0, 19519.924459435246},
       {100.0, -3422.086148396289, 4359.66759610496, 5412.657293098717, -5000.0, 19519.206477138778}},
  };
  for (const PublishedCase& c : cases) {
    const Vector6 start = Vector6(c.a_roe_start) / c.chief.a;
    const Vector6 end = c.chief.a * (roe_transition_j2(c.chief, c.duration) * start);
    const QnsElements deputy = qns_from_roe(c.chief, start);
    const Vector6 secular =
        c.chief.a * roe_from_qns(propagate_secular(c.chief, c.duration), propagate_secular(deputy, c.duration));
    for (int k = 0; k < 6; ++k) {
      EXPECT_NEAR(end(k), c.a_roe_end[k], 2e-8)
          << "ROE " << k << " after " << c.orbits;  // rounding of 2e4 m over 10 orbits
      EXPECT_NEAR(secular(k), c.a_roe_secular[k], 1e-6)
          << "ROE " << k << " after " << c.orbits;  // of u at 63 rad times 1e7 m
    }
  }
}

TEST(Transition, IsTheJacobianOfTheSecularMotion) {
  std::mt19937_64 generator(4);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int k = 0; k < 200; ++k) {
    const double e = 0.5 * unit(generator);
    const double w = 6.2 * unit(generator);
    const QnsElements chief{.a = 6.8e6 + 5e6 * unit(generator),
                            .ex = e * std::cos(w),
                            .ey = e * std::sin(w),
                            .i = 0.2 + 2.7 * unit(generator),
                            .raan = 1.0,
                            .u = 1.0};
    const double tau = 90000.0 * unit(generator);
    const Matrix6 phi = roe_transition_j2(chief, tau);
    const QnsElements chief_end = propagate_secular(chief, tau);
    const double h = 1e-5;
    for (int column = 0; column < 6; ++column) {
      const auto end = [&](double step) {
        const Vector6 roe = step * Vector6::Unit(column);
        return roe_from_qns(chief_end, propagate_secular(qns_from_roe(chief, roe), tau));
      };
      const Vector6 slope = (end(h) - end(-h)) / (2.0 * h);
      // Central difference: h^2 = 1e-10 of slopes up to 200 (dl after 15 orbits), and 2e-14 of rounding of u over 2e-5.
      ASSERT_LT(accuracy::largest_entry(slope - phi.col(column)), 2e-7) << "column " << column << ", tau = " << tau;
    }
  }
}

TEST(Transition, Composes) {
  const QnsElements chief = from_keplerian(7.5e6, 0.1, 60, 0, 30, 10);
  const Matrix6 whole = roe_transition_j2(chief, 50000.0);
  const Matrix6 parts =
      roe_transition_j2(propagate_secular(chief, 20000.0), 30000.0) * roe_transition_j2(chief, 20000.0);
  EXPECT_LT(accuracy::largest_entry(whole - parts), 1e-13);  // rounding of elements up to 75
}

}  // namespace

// The on-board coast against a slow reference integration.

namespace {

TEST(ReferenceOrbit, AgreesWithAnIndependentProgram) {
  // J2-only truth of the mission orbit after six hours, printed to 1e-4 m and 1e-6 m/s.
  const CartesianState end = reference::fly(cartesian_from_qns(mission::kServicerOsculating).value(), 21600.0, 1.0);
  EXPECT_NEAR(end.position_eci.x(), 750773.9627, 1e-3);  // the program's own integration error is of this order
  EXPECT_NEAR(end.position_eci.y(), 4583790.1554, 1e-3);
  EXPECT_NEAR(end.position_eci.z(), -5352715.4900, 1e-3);
  EXPECT_NEAR(end.velocity_eci.x(), 712.735141, 1e-6);
  EXPECT_NEAR(end.velocity_eci.y(), -5721.338951, 1e-6);
  EXPECT_NEAR(end.velocity_eci.z(), -4787.387539, 1e-6);
}

TEST(Propagate, KeepsItsStatedAccuracy) {
  // From several places in the orbit, forwards and backwards.
  for (int k = 0; k < 12; ++k) {
    QnsElements q = mission::kServicerOsculating;
    q.u = k * 30.0 * mission::kDegree;
    const CartesianState start = cartesian_from_qns(q).value();
    for (double sign : {1.0, -1.0}) {
      const CartesianState ten_minutes = propagate_j2(start, sign * 600.0).value();
      const CartesianState truth = reference::fly(start, sign * 600.0);
      EXPECT_LT((ten_minutes.position_eci - truth.position_eci).norm(), 2e-3);
      EXPECT_LT((ten_minutes.velocity_eci - truth.velocity_eci).norm(), 2e-6);
    }
    const CartesianState two_hours = propagate_j2(start, 7200.0).value();
    EXPECT_LT((two_hours.position_eci - reference::fly(start, 7200.0).position_eci).norm(), 0.3);
  }
}

TEST(Propagate, ErrorFallsWithTheFourthPowerOfTheStep) {
  const CartesianState start = cartesian_from_qns(mission::kServicerOsculating).value();
  // 10 s in one step, and in two by hand: the local error is of fifth order, so two half steps have a sixteenth of it.
  const Vector3 truth = reference::fly(start, 10.0, 0.1).position_eci;
  const double one = (propagate_j2(start, 10.0).value().position_eci - truth).norm();
  const CartesianState half = propagate_j2(start, 5.0).value();
  const double two = (propagate_j2(half, 5.0).value().position_eci - truth).norm();
  EXPECT_NEAR(one / two, 16.0, 2.0);
}

TEST(Propagate, AccelerationIsTheGradientOfThePotential) {
  const auto potential = [](const Vector3& r) {
    const double radius = r.norm();
    const double s = r.z() / radius;
    return kMu / radius * (1.0 - kJ2 * std::pow(kEarthRadius / radius, 2) * (1.5 * s * s - 0.5));
  };
  const Vector3 r(3.1e6, -4.2e6, 4.9e6);
  const double h = 100.0;  // m
  for (int k = 0; k < 3; ++k) {
    const Vector3 step = h * Vector3::Unit(k);
    const double slope = (potential(r + step) - potential(r - step)) / (2.0 * h);
    // Central difference: (h/r)^2 = 2e-10 of 8 m/s^2, and rounding of 6e7 J/kg by 200 m.
    EXPECT_NEAR(acceleration_j2(r)(k), slope, 1e-8);
  }
}

TEST(Propagate, RefusesWhatItCannotCoast) {
  const CartesianState start = cartesian_from_qns(mission::kServicerOsculating).value();
  EXPECT_EQ(propagate_j2(start, 7201.0).status(), Status::kOutOfRange);
  EXPECT_EQ(propagate_j2(start, -7201.0).status(), Status::kOutOfRange);
  EXPECT_EQ(propagate_j2(start, std::numeric_limits<double>::quiet_NaN()).status(), Status::kNotFinite);
  EXPECT_EQ(propagate_j2(start, std::numeric_limits<double>::infinity()).status(), Status::kNotFinite);
  CartesianState bad = start;
  bad.position_eci *= 0.5;
  EXPECT_EQ(propagate_j2(bad, 10.0).status(), Status::kOutOfRange);
  bad = start;
  bad.velocity_eci.z() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(propagate_j2(bad, 10.0).status(), Status::kNotFinite);
  const CartesianState same = propagate_j2(start, 0.0).value();
  EXPECT_EQ(same.position_eci, start.position_eci);
}

}  // namespace

// The control matrix against what impulses really do to a Keplerian orbit.

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
