// Brouwer's map between mean and osculating elements: oracles of other programs, its inverse, and its range.

#include "fsw/orbit/mean_osculating.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "fsw/orbit/gravity_field.h"
#include "fsw/orbit/propagate.h"
#include "fsw/orbit/roe.h"
#include "fsw/orbit/rtn.h"
#include "tests/support/figures.h"
#include "tests/unit/fsw/orbit/longitude_term.h"
#include "tests/unit/fsw/orbit/mission.h"
#include "tests/unit/fsw/orbit/reference_orbit.h"

namespace vbar::fsw::orbit {

namespace {

constexpr double kDegree = mission::kDegree;

double eccentric_from_true(double f, double e) {
  return 2.0 * std::atan(std::sqrt((1.0 - e) / (1.0 + e)) * std::tan(f / 2.0));
}

TEST(MeanOsculating, MissionOrbitHasPrismasMeanElements) {
  const QnsElements mean = mean_from_osculating(mission::kServicerOsculating).value();
  // An independent implementation; tolerances are half a unit of its printed digits.
  EXPECT_NEAR(mean.a, 7078138.944, 5e-4);
  EXPECT_NEAR(mean.ex, 0.00104134174, 5e-12);
  EXPECT_NEAR(mean.ey, 1.5923745e-5, 5e-13);
  EXPECT_NEAR(mean.i / kDegree, 98.1853293, 5e-8);
  EXPECT_NEAR(mean.raan / kDegree, -90.0001291, 5e-8);
  EXPECT_NEAR(mean.u / kDegree, -0.6886792, 5e-8);
}

TEST(MeanOsculating, MatchesBasilisksClassicElements) {
  // Basilisk, unit test of clMeanOscMap: a = 1000, e = 0.2, i = 0.2, raan = 0.15, w = 0.5, f = 0.2 with Re = 300, J2 =
  // 1e-3. The theory depends on J2 (Re/a)^2 only, so the same orbit about the Earth has this semi-major axis:
  const double e = 0.2;
  const double w = 0.5;
  const double a = kEarthRadius * std::sqrt(kJ2 / (1e-3 * 0.09));
  const double eccentric = eccentric_from_true(0.2, e);
  const QnsElements mean{.a = a,
                         .ex = e * std::cos(w),
                         .ey = e * std::sin(w),
                         .i = 0.2,
                         .raan = 0.15,
                         .u = w + eccentric - e * std::sin(eccentric)};
  const QnsElements osculating = osculating_from_mean(mean).value();
  const double e_osc = std::hypot(osculating.ex, osculating.ey);
  const double w_osc = std::atan2(osculating.ey, osculating.ex);
  const double f_osc = true_argument_of_latitude(osculating) - w_osc;
  // Rounding of the two programs' different arithmetic: a few 1e-15 each.
  EXPECT_NEAR(osculating.a / a * 1000.0, 1000.07546442015951, 1e-12);
  EXPECT_NEAR(e_osc, 0.20017786852908629, 1e-15);
  EXPECT_NEAR(osculating.i, 0.20000333960738948, 1e-15);
  EXPECT_NEAR(osculating.raan, 0.15007256499303692, 1e-15);
  EXPECT_NEAR(f_osc, 0.19982315726261962, 1e-14);

  // Basilisk's argument of perigee lacks a term of the mean longitude; here it is, by itself.
  const double missing = longitude_term(mean);
  EXPECT_NEAR(w_osc - missing, 0.50011857315729336, 1e-14);
  EXPECT_GT(missing, 3e-6);  // it is there to be seen
}

TEST(MeanOsculating, NearCircularLimitIsTheTextbookForm) {
  // Kozai's short-period terms at e = 0, which drop e J2: the tolerance.
  const double a = 7078138.944;
  const double i = 98.1853 * kDegree;
  const double g = 1.5 * kJ2 * std::pow(kEarthRadius / a, 2);
  const double s2 = std::pow(std::sin(i), 2);
  const double e = 1e-6;
  const double tolerance = 10.0 * e * g;
  for (int k = 0; k < 36; ++k) {
    const double u = k * 10.0 * kDegree;
    const QnsElements mean{.a = a, .ex = e, .ey = 0.0, .i = i, .raan = 1.0, .u = u};
    const QnsElements osc = osculating_from_mean(mean).value();
    EXPECT_NEAR((osc.a - a) / a, g * s2 * std::cos(2 * u), tolerance);
    EXPECT_NEAR(osc.ex - e, g * ((1.0 - 1.25 * s2) * std::cos(u) + 7.0 / 12.0 * s2 * std::cos(3 * u)),
                tolerance + g * g);
    EXPECT_NEAR(osc.ey, g * ((1.0 - 1.75 * s2) * std::sin(u) + 7.0 / 12.0 * s2 * std::sin(3 * u)), tolerance + g * g);
    EXPECT_NEAR(osc.i - i, 0.25 * g * std::sin(2 * i) * std::cos(2 * u), tolerance + g * g);
    EXPECT_NEAR(osc.raan - 1.0, 0.5 * g * std::cos(i) * std::sin(2 * u), tolerance + g * g);
    EXPECT_NEAR(osc.u - u, 0.25 * g * (3.0 - 5.0 * std::pow(std::cos(i), 2)) * std::sin(2 * u), tolerance + g * g);
  }
}

TEST(MeanOsculating, IsContinuousThroughZeroEccentricity) {
  QnsElements circular{.a = 7.1e6, .ex = 0.0, .ey = 0.0, .i = 1.2, .raan = 0.3, .u = 0.9};
  const QnsElements at_zero = osculating_from_mean(circular).value();
  for (double w : {0.0, 1.0, 2.0, 3.0, 4.0, 5.0}) {
    QnsElements nearly = circular;
    nearly.ex = 1e-12 * std::cos(w);
    nearly.ey = 1e-12 * std::sin(w);
    const QnsElements q = osculating_from_mean(nearly).value();
    // The map is smooth, so a change of 1e-12 changes the image by as much.
    EXPECT_NEAR(q.a / at_zero.a, 1.0, 1e-13);
    EXPECT_NEAR(q.ex, at_zero.ex, 2e-12);
    EXPECT_NEAR(q.ey, at_zero.ey, 2e-12);
    EXPECT_NEAR(q.i, at_zero.i, 1e-13);
    EXPECT_NEAR(q.raan, at_zero.raan, 1e-13);
    EXPECT_NEAR(q.u, at_zero.u, 3e-12);
  }
  EXPECT_TRUE(mean_from_osculating(circular).ok());
}

TEST(MeanOsculating, InverseFindsTheMeanElements) {
  std::mt19937_64 generator(3);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int k = 0; k < 5000; ++k) {
    const double e = 0.05 * unit(generator);
    const double w = 6.2 * unit(generator);
    const QnsElements mean{.a = 6.8e6 + 2e6 * unit(generator),
                           .ex = e * std::cos(w),
                           .ey = e * std::sin(w),
                           .i = 0.2 + 2.7 * unit(generator),
                           .raan = 6.0 * unit(generator) - 3.0,
                           .u = 300.0 * unit(generator) - 100.0};
    const Result<QnsElements> osculating = osculating_from_mean(mean);
    ASSERT_TRUE(osculating.ok());
    const Result<QnsElements> back = mean_from_osculating(osculating.value());
    ASSERT_TRUE(back.ok());
    // Converged to 1e-12, with a last correction J2 times as large left over; u carries 3e-14 of rounding at 200 rad.
    ASSERT_NEAR(back.value().a / mean.a, 1.0, 1e-13);
    ASSERT_NEAR(back.value().ex, mean.ex, 1e-13);
    ASSERT_NEAR(back.value().ey, mean.ey, 1e-13);
    ASSERT_NEAR(back.value().i, mean.i, 1e-13);
    ASSERT_NEAR(back.value().raan, mean.raan, 1e-13);
    ASSERT_NEAR(back.value().u, mean.u, 1e-13);
  }
}

/// Peak-to-peak of what should be constant, over three orbits of J2-only truth, every 60 s. Lengths in m.
struct Swing {
  double osculating_a = 0.0;
  double mean_a = 0.0;
  double mean_u = 0.0;  ///< a times u less its secular motion
};

Swing swing_over_three_orbits(const QnsElements& osculating_start) {
  struct Range {
    accuracy::Smallest low;
    accuracy::Largest high{-std::numeric_limits<double>::infinity()};
    void add(double x) {
      low.add(x);
      high.add(x);
    }
  };
  Range osculating_a, mean_a, mean_u;
  CartesianState state = cartesian_from_qns(osculating_start).value();
  const int steps = static_cast<int>(3.0 * math::kTwoPi / mean_motion(osculating_start.a) / 60.0);
  double u_rate = 0.0;
  double first_u = 0.0;
  double last_u = 0.0;
  std::vector<double> u;
  for (int k = 0; k <= steps; ++k) {
    const QnsElements osculating = qns_from_cartesian(state).value();
    const QnsElements mean = mean_from_osculating(osculating).value();
    osculating_a.add(osculating.a);
    mean_a.add(mean.a);
    if (k == 0) first_u = last_u = mean.u;
    last_u += std::remainder(mean.u - last_u, math::kTwoPi);
    u.push_back(last_u);
    state = reference::fly(state, 60.0);
  }
  // The secular rate of truth is the slope over whole orbits; theory's differs by its own second order.
  u_rate = (u.back() - first_u) / steps;
  double sxy = 0.0;
  double sxx = 0.0;
  double mean_residual = 0.0;
  for (int k = 0; k <= steps; ++k) mean_residual += (u[static_cast<std::size_t>(k)] - u_rate * k) / (steps + 1);
  for (int k = 0; k <= steps; ++k) {
    const double x = k - 0.5 * steps;
    sxy += x * (u[static_cast<std::size_t>(k)] - u_rate * k - mean_residual);
    sxx += x * x;
  }
  u_rate += sxy / sxx;
  for (int k = 0; k <= steps; ++k) mean_u.add(osculating_start.a * (u[static_cast<std::size_t>(k)] - u_rate * k));
  return {osculating_a.high - osculating_a.low, mean_a.high - mean_a.low, mean_u.high - mean_u.low};
}

TEST(MeanOsculating, LeavesOfAnOscillationOfKilometresItsSecondOrder) {
  const Swing swing = swing_over_three_orbits(mission::kServicerOsculating);
  // What an independent implementation of the first-order theory leaves on this orbit: 18.28 km; 31 m; 11 to 14 m.
  EXPECT_NEAR(swing.osculating_a, 18280.0, 5.0);  // printed to 10 m
  EXPECT_NEAR(swing.mean_a, 31.0, 1.0);           // printed to 1 m
  EXPECT_LT(swing.mean_u, 15.0);
}

TEST(MeanOsculating, TermThatOthersMissMakesTheMeanLongitudeSteady) {
  // e = 0.1, i = 40 deg: without the term the mean u swings by 598 m, with it by 17 m (independent implementation; its
  // semi-major axis is not known, and the second order goes with a^-3 or so).
  const QnsElements q{
      .a = 7.5e6, .ex = 0.1 * std::cos(0.6), .ey = 0.1 * std::sin(0.6), .i = 40.0 * kDegree, .raan = 0.0, .u = 0.0};
  EXPECT_LT(swing_over_three_orbits(q).mean_u, 25.0);
}

TEST(MeanOsculating, DropsTheLongPeriodTermsNearTheCriticalInclination) {
  const double critical = std::acos(std::sqrt(0.2));
  const QnsElements at{.a = 7.2e6, .ex = 0.01, .ey = 0.02, .i = critical, .raan = 0.0, .u = 1.0};
  const Result<QnsElements> osculating = osculating_from_mean(at);
  ASSERT_TRUE(osculating.ok());
  // Without the band 1/(1 - 5 cos^2 i) would be infinite; all first-order corrections are of size J2.
  EXPECT_LT(std::abs(osculating.value().ex - at.ex), 2.0 * kJ2);
  EXPECT_LT(std::abs(osculating.value().ey - at.ey), 2.0 * kJ2);
  EXPECT_LT(std::abs(osculating.value().u - at.u), 4.0 * kJ2);
  EXPECT_TRUE(mean_from_osculating(at).ok());
}

TEST(MeanOsculating, KeepsTheBranchOfTheAngles) {
  QnsElements q = mission::kServicerOsculating;
  q.u += 20.0 * math::kTwoPi;
  q.raan -= math::kTwoPi;
  const QnsElements mean = mean_from_osculating(q).value();
  const QnsElements near = mean_from_osculating(mission::kServicerOsculating).value();
  EXPECT_NEAR(mean.u - near.u, 20.0 * math::kTwoPi, 1e-13);  // rounding of an angle of 126 rad
  EXPECT_NEAR(mean.raan - near.raan, -math::kTwoPi, 1e-14);
}

TEST(MeanOsculating, RefusesWhatTheTheoryDoesNotCover) {
  const QnsElements good = mission::kServicerOsculating;
  QnsElements q = good;
  q.i = 0.5e-4;
  EXPECT_EQ(osculating_from_mean(q).status(), Status::kOutOfRange);
  EXPECT_EQ(mean_from_osculating(q).status(), Status::kOutOfRange);
  q.i = math::kPi - 0.5e-4;
  EXPECT_EQ(osculating_from_mean(q).status(), Status::kOutOfRange);
  q = good;
  q.ex = 0.9;
  EXPECT_EQ(osculating_from_mean(q).status(), Status::kOutOfRange);
  q = good;
  q.a = 0.0;
  EXPECT_EQ(osculating_from_mean(q).status(), Status::kOutOfRange);
  for (double QnsElements::*field :
       {&QnsElements::a, &QnsElements::ex, &QnsElements::ey, &QnsElements::i, &QnsElements::raan, &QnsElements::u}) {
    q = good;
    q.*field = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(osculating_from_mean(q).status(), Status::kNotFinite);
    EXPECT_EQ(mean_from_osculating(q).status(), Status::kNotFinite);
  }
  q = good;
  q.a = 1000.0;  // deep inside the Earth the correction is larger than what it corrects
  EXPECT_FALSE(mean_from_osculating(q).ok());
}

}  // namespace

// How well mean ROE and their J2 drift describe the real relative motion: against six hours of point mass and J2
// integrated slowly, from the same osculating states. The bounds are what an independent implementation of the same
// theory reached.

namespace {

CartesianState cartesian_from_mean(const QnsElements& mean) {
  return cartesian_from_qns(osculating_from_mean(mean).value()).value();
}

QnsElements mean_from_cartesian(const CartesianState& state) {
  return mean_from_osculating(qns_from_cartesian(state).value()).value();
}

/// Largest errors of a * ROE, m, over six hours, every ten minutes.
struct Errors {
  Vector6 linear = Vector6::Zero();   ///< of the transition matrix
  Vector6 secular = Vector6::Zero();  ///< of both mean orbits moved on by their own rates
};

Errors errors_over_six_hours(const Vector6& roe) {
  const QnsElements chief_mean = mission::kServicerMean;
  const QnsElements deputy_mean = qns_from_roe(chief_mean, roe);
  CartesianState chief = cartesian_from_mean(chief_mean);
  CartesianState deputy = cartesian_from_mean(deputy_mean);
  Errors worst;
  for (int k = 1; k <= 36; ++k) {
    chief = reference::fly(chief, 600.0);
    deputy = reference::fly(deputy, 600.0);
    const double t = 600.0 * k;
    const Vector6 truth = roe_from_qns(mean_from_cartesian(chief), mean_from_cartesian(deputy));
    const Vector6 linear = roe_transition_j2(chief_mean, t) * roe;
    const Vector6 secular = roe_from_qns(propagate_secular(chief_mean, t), propagate_secular(deputy_mean, t));
    worst.linear = worst.linear.cwiseMax(chief_mean.a * (linear - truth).cwiseAbs());
    worst.secular = worst.secular.cwiseMax(chief_mean.a * (secular - truth).cwiseAbs());
  }
  return worst;
}

TEST(MeanRoeAccuracy, AtFiftyKilometresIsBelowAMetre) {
  Vector6 roe;
  roe << 0.0, -50000.0, 0.0, 1000.0, 0.0, 1000.0;
  const Vector6 error = errors_over_six_hours(roe / mission::kReferenceA).linear;
  EXPECT_LT(error(0), 0.33);
  EXPECT_LT(error(1), 0.25);
  EXPECT_LT(error(2), 0.32);
  EXPECT_LT(error(3), 0.33);
  EXPECT_LT(std::hypot(error(4), error(5)), 0.026);
}

TEST(MeanRoeAccuracy, AtTenMetresIsATenthOfAMillimetre) {
  const Vector6 error = errors_over_six_hours(mission::kWaypoints[8].roe()).linear;
  for (int k = 0; k < 6; ++k) EXPECT_LT(error(k), 1.5e-4) << "ROE " << k;
}

TEST(MeanRoeAccuracy, FarAwayAsksForTwoOrbitsInsteadOfOneMatrix) {
  // Waypoint 0: 75 km and closing. The matrix loses 24 m along track, the nonlinear secular motion 0.3 m.
  const Errors errors = errors_over_six_hours(mission::kWaypoints[0].roe());
  EXPECT_NEAR(errors.linear(1), 24.0, 1.0);
  EXPECT_LT(errors.secular(1), 0.5);
}

TEST(MeanRoeAccuracy, RelativePositionIsPredictedThroughTheOsculatingOrbits) {
  // From waypoint 8, six hours on: the mean ROE moved by the matrix, mapped back to RTN about the true servicer.
  const QnsElements chief_mean = mission::kServicerMean;
  const Vector6 roe = mission::kWaypoints[8].roe();
  CartesianState chief = cartesian_from_mean(chief_mean);
  CartesianState deputy = cartesian_from_mean(qns_from_roe(chief_mean, roe));
  for (int k = 1; k <= 12; ++k) {
    chief = reference::fly(chief, 1800.0);
    deputy = reference::fly(deputy, 1800.0);
    const Vector3 truth = relative_state_rtn(chief, deputy).position_rtn;
    const Vector6 drifted = roe_transition_j2(chief_mean, 1800.0 * k) * roe;
    const Vector3 predicted = relative_state_from_mean_roe(mean_from_cartesian(chief), drifted).value().position_rtn;
    EXPECT_LT((predicted - truth).norm(), 5e-4);  // a tenth of a millimetre of each ROE, twice in T, in three axes
  }
}

}  // namespace

}  // namespace vbar::fsw::orbit
