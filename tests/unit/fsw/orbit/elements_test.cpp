// QNS elements against inertial states: oracles, round trips, and the edges of what they can express.

#include "fsw/orbit/elements.h"

#include <cmath>
#include <limits>
#include <random>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "fsw/orbit/gravity_field.h"
#include "fsw/orbit/mean_osculating.h"
#include "fsw/orbit/propagate.h"
#include "fsw/orbit/roe.h"
#include "fsw/orbit/rtn.h"
#include "tests/support/figures.h"
#include "tests/unit/fsw/orbit/longitude_term.h"
#include "tests/unit/fsw/orbit/mission.h"
#include "tests/unit/fsw/orbit/reference_orbit.h"

namespace vbar::fsw::orbit {

namespace {

constexpr double kPi = math::kPi;

TEST(Elements, OfTheMissionGiveItsInertialState) {
  // Computed with an independent program from the paper's element table; printed to 1e-7 m and 1e-10 m/s.
  const CartesianState state = cartesian_from_qns(mission::kServicerOsculating).value();
  EXPECT_NEAR(state.position_eci.x(), 12161.8456633, 1e-7);
  EXPECT_NEAR(state.position_eci.y(), -7076153.584868, 1e-6);
  EXPECT_NEAR(state.position_eci.z(), -84606.5539942, 1e-7);
  EXPECT_NEAR(state.velocity_eci.x(), -1068.5690877908, 1e-9);
  EXPECT_NEAR(state.velocity_eci.y(), -90.5830005301, 1e-9);
  EXPECT_NEAR(state.velocity_eci.z(), 7433.7358593127, 1e-9);
}

TEST(Elements, MeanMotionOfTheMissionOrbit) {
  EXPECT_NEAR(mean_motion(7078138.944), 1.06020601e-3, 5e-12);  // half a unit of the oracle's last digit
  EXPECT_NEAR(2.0 * kPi / mean_motion(7078138.944), 5926.3815, 5e-5);
}

TEST(Elements, SurviveTheRoundTripThroughInertialStates) {
  std::mt19937_64 generator(1);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int k = 0; k < 20000; ++k) {
    const double e = 0.1 * unit(generator);
    const double w = 2.0 * kPi * unit(generator);
    const QnsElements q{.a = 6.8e6 + 2e6 * unit(generator),
                        .ex = e * std::cos(w),
                        .ey = e * std::sin(w),
                        .i = 0.01 + (kPi - 0.02) * unit(generator),
                        .raan = kPi * (2.0 * unit(generator) - 1.0),
                        .u = kPi * (2.0 * unit(generator) - 1.0)};
    const CartesianState state = cartesian_from_qns(q).value();
    const CartesianState again = cartesian_from_qns(qns_from_cartesian(state).value()).value();
    // A double resolves 9e-10 m at this radius; 1e-8 m is a dozen roundings.
    ASSERT_LT((state.position_eci - again.position_eci).norm(), 1e-8) << "i = " << q.i;
    ASSERT_LT((state.velocity_eci - again.velocity_eci).norm(), 1e-11);
  }
}

TEST(Elements, OfTheMissionSurviveTheRoundTripWithinRounding) {
  for (int k = 0; k < 360; ++k) {
    QnsElements q = mission::kServicerOsculating;
    q.u = (k - 179) * mission::kDegree;
    const CartesianState state = cartesian_from_qns(q).value();
    const QnsElements back = qns_from_cartesian(state).value();
    const CartesianState again = cartesian_from_qns(back).value();
    ASSERT_LT((state.position_eci - again.position_eci).norm(), 1e-8);  // ten roundings of 9e-10 m
    ASSERT_NEAR(back.a, q.a, 2e-8);   // 1/a from a difference of two terms of twice its size
    ASSERT_NEAR(back.u, q.u, 4e-15);  // a few roundings of an angle near pi
    ASSERT_NEAR(back.ex, q.ex, 2e-15);
    ASSERT_NEAR(back.ey, q.ey, 2e-15);
  }
}

TEST(Elements, OfEccentricOrbitsSurviveTheRoundTrip) {
  for (double e : {0.2, 0.5, 0.7, 0.9, 0.94}) {
    for (int k = 0; k < 720; ++k) {
      const double w = 0.1 * k;
      const QnsElements q{.a = 2e7,
                          .ex = e * std::cos(w),
                          .ey = e * std::sin(w),
                          .i = 1.1,
                          .raan = 2.0,
                          .u = math::wrap_to_pi(0.0123 * k * k)};
      const CartesianState state = cartesian_from_qns(q).value();
      const QnsElements back = qns_from_cartesian(state).value();
      // Near apogee of e = 0.94 the mean longitude is (1 - e)^-2 times as sensitive to the state's rounding as at e =
      // 0.
      ASSERT_NEAR(math::wrap_to_pi(back.u - q.u), 0.0, 1e-12) << "e = " << e << ", k = " << k;
      ASSERT_NEAR(back.ex, q.ex, 1e-13);
      ASSERT_NEAR(back.ey, q.ey, 1e-13);
    }
  }
}

TEST(Elements, AreRegularOnACircularOrbit) {
  const QnsElements q{.a = 7e6, .ex = 0.0, .ey = 0.0, .i = 1.0, .raan = 0.5, .u = 2.0};
  const CartesianState state = cartesian_from_qns(q).value();
  EXPECT_NEAR(state.position_eci.norm(), 7e6, 4e-9);  // four roundings
  EXPECT_NEAR(state.velocity_eci.norm(), std::sqrt(kMu / 7e6), 4e-12);
  EXPECT_NEAR(state.position_eci.dot(state.velocity_eci), 0.0, 1e-4);  // 5e10 m^2/s times 1e-16 rounding
  const QnsElements back = qns_from_cartesian(state).value();
  EXPECT_NEAR(back.ex, 0.0, 1e-15);
  EXPECT_NEAR(back.ey, 0.0, 1e-15);
  EXPECT_NEAR(back.u, 2.0, 1e-15);
  EXPECT_NEAR(true_argument_of_latitude(q), 2.0, 1e-15);
}

TEST(Elements, TrueArgumentOfLatitudeAtTheApsides) {
  // At perigee and apogee the true and the mean anomaly agree.
  const double w = 0.7;
  QnsElements q{.a = 8e6, .ex = 0.1 * std::cos(w), .ey = 0.1 * std::sin(w), .i = 1.0, .raan = 0.0, .u = w};
  EXPECT_NEAR(true_argument_of_latitude(q), w, 1e-15);
  q.u = w + kPi;
  EXPECT_NEAR(true_argument_of_latitude(q), w - kPi, 1e-15);
  q.ex = 2.0;
  EXPECT_TRUE(std::isnan(true_argument_of_latitude(q)));
}

TEST(Elements, RefuseWhatIsNoOrbit) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  QnsElements q = mission::kServicerOsculating;
  q.u = nan;
  EXPECT_EQ(cartesian_from_qns(q).status(), Status::kNotFinite);
  q = mission::kServicerOsculating;
  q.raan = std::numeric_limits<double>::infinity();
  EXPECT_EQ(cartesian_from_qns(q).status(), Status::kNotFinite);
  q = mission::kServicerOsculating;
  q.a = -7e6;
  EXPECT_EQ(cartesian_from_qns(q).status(), Status::kOutOfRange);
  q = mission::kServicerOsculating;
  q.ex = 0.96;
  EXPECT_EQ(cartesian_from_qns(q).status(), Status::kOutOfRange);

  CartesianState state = cartesian_from_qns(mission::kServicerOsculating).value();
  CartesianState bad = state;
  bad.velocity_eci *= 1.5;  // beyond sqrt(2) times the circular speed: hyperbolic
  EXPECT_EQ(qns_from_cartesian(bad).status(), Status::kOutOfRange);
  bad = state;
  bad.velocity_eci = state.position_eci * 1e-3;  // rectilinear
  EXPECT_EQ(qns_from_cartesian(bad).status(), Status::kOutOfRange);
  bad = state;
  bad.position_eci.setZero();
  EXPECT_EQ(qns_from_cartesian(bad).status(), Status::kOutOfRange);
  bad = state;
  bad.position_eci.y() = nan;
  EXPECT_EQ(qns_from_cartesian(bad).status(), Status::kNotFinite);
  bad = {.position_eci = {7e6, 0.0, 0.0}, .velocity_eci = {0.0, 7500.0, 0.0}};  // equatorial
  EXPECT_EQ(qns_from_cartesian(bad).status(), Status::kOutOfRange);
  bad.position_eci = Vector3::Constant(1e200);  // overflows on the way
  EXPECT_FALSE(qns_from_cartesian(bad).ok());
}

TEST(Kepler, IsSolvedForEveryEccentricityAndLongitude) {
  for (int j = 0; j <= 40; ++j) {
    const double e = kMaxEccentricity * j / 40;
    for (int k = -360; k <= 360; ++k) {
      const double u = k * 0.5 * mission::kDegree;
      for (double w : {0.0, 1.0, -2.5}) {
        const double ex = e * std::cos(w);
        const double ey = e * std::sin(w);
        const Result<EccentricLatitude> root = solve_kepler(ex, ey, u);
        ASSERT_TRUE(root.ok()) << "e = " << e << ", u = " << u << ", w = " << w;
        const EccentricLatitude& f = root.value();
        ASSERT_NEAR(f.angle - ex * std::sin(f.angle) + ey * std::cos(f.angle), u, 2e-15);  // a few roundings
        ASSERT_NEAR(f.sin, std::sin(f.angle), 4e-16);
        ASSERT_NEAR(f.cos, std::cos(f.angle), 4e-16);
      }
    }
  }
}

TEST(Kepler, RefusesWhatHasNoEllipse) {
  EXPECT_EQ(solve_kepler(0.9, 0.5, 1.0).status(), Status::kOutOfRange);
  EXPECT_EQ(solve_kepler(std::numeric_limits<double>::quiet_NaN(), 0.0, 1.0).status(), Status::kNotFinite);
  EXPECT_EQ(solve_kepler(0.0, 0.0, std::numeric_limits<double>::infinity()).status(), Status::kNotFinite);
}

}  // namespace

// The RTN frame and the exact relative state of mean ROE.

namespace {

TEST(Rtn, AxesAreRadialTransverseNormal) {
  const CartesianState state = cartesian_from_qns(mission::kServicerOsculating).value();
  const Matrix3 R = R_rtn_eci(state);
  EXPECT_LT(accuracy::largest_entry(R * R.transpose() - Matrix3::Identity()), 4e-16);  // two roundings
  EXPECT_LT((R.row(0).cross(R.row(1)) - R.row(2)).norm(), 4e-16);                      // right-handed
  const Vector3 r = R * state.position_eci;
  const Vector3 v = R * state.velocity_eci;
  EXPECT_NEAR(r.x(), state.position_eci.norm(), 4e-9);
  EXPECT_NEAR(r.y(), 0.0, 4e-9);
  EXPECT_NEAR(r.z(), 0.0, 4e-9);
  EXPECT_GT(v.y(), 7000.0);  // T is forward
  EXPECT_NEAR(v.z(), 0.0, 1e-12);
}

TEST(Rtn, VelocityIsTheRateOfThePositionInTheRotatingFrame) {
  const QnsElements chief = mission::kServicerOsculating;
  Vector6 roe;
  roe << 1e-4, -2e-3, 3e-4, -4e-4, 5e-4, 6e-4;
  const QnsElements deputy = qns_from_roe(chief, roe);
  const double h = 0.5;  // s
  const auto at = [&](double t) {
    QnsElements c = chief;
    QnsElements d = deputy;
    c.u += mean_motion(c.a) * t;
    d.u += mean_motion(d.a) * t;
    return relative_state_rtn(cartesian_from_qns(c).value(), cartesian_from_qns(d).value());
  };
  const Vector3 rate = (at(h).position_rtn - at(-h).position_rtn) / (2.0 * h);
  // Central difference over positions of 14 km that turn at n = 1e-3 rad/s: 14 km n^3 h^2/6 = 6e-7 m/s.
  EXPECT_LT((rate - at(0.0).velocity_rtn).norm(), 2e-6);
}

TEST(Rtn, ImpulseActsInTheOwnFrame) {
  const CartesianState state = cartesian_from_qns(mission::kServicerOsculating).value();
  const Vector3 dv(0.1, -0.2, 0.3);
  const CartesianState after = apply_impulse_rtn(state, dv);
  EXPECT_EQ(after.position_eci, state.position_eci);
  const Vector3 seen = R_rtn_eci(state) * (after.velocity_eci - state.velocity_eci);
  EXPECT_LT((seen - dv).norm(), 2e-12);  // rounding of velocities of 7.4 km/s
  EXPECT_NEAR(state.position_eci.normalized().dot(after.velocity_eci - state.velocity_eci), 0.1, 1e-12);
}

TEST(Rtn, OfTheWaypointsIsExact) {
  // Independent program: mean ROE about the servicer's mean orbit, unburned to the waypoint's time; both through the
  // osculating states. It lacks a term of the longitude, which here is taken off along track. The tolerances are the
  // oracle's: its constants' last digits weigh with the distance, the rest is its printed resolution.
  struct Row {
    std::size_t waypoint;
    double u_deg, r, t, n;
  };
  for (const Row& row : {Row{0, -0.689, -2393.793, -75134.098, -13.938}, Row{1, -130.179, 564.564, -48696.594, 658.592},
                         Row{4, -158.652, 11.5196, -944.1205, 28.1798}, Row{8, -122.379, 1.19963, -7.85458, 0.53876},
                         Row{9, 96.040, 0.09866, -5.01157, 1.99107}, Row{10, 9.062, -0.98940, -8.20167, 0.15651}}) {
    const mission::Waypoint& waypoint = mission::kWaypoints[row.waypoint];
    const QnsElements chief = propagate_secular(mission::kServicerMean, waypoint.time_h * 3600.0);
    EXPECT_NEAR(math::wrap_to_pi(chief.u) / mission::kDegree, row.u_deg, 6e-4);
    const Vector3 rtn = relative_state_from_mean_roe(chief, waypoint.roe()).value().position_rtn;
    const double term = longitude_term(qns_from_roe(chief, waypoint.roe())) - longitude_term(chief);
    const double tolerance = 1e-5 + 1e-7 * std::abs(row.t);
    EXPECT_NEAR(rtn.x(), row.r, tolerance) << "waypoint " << row.waypoint;
    EXPECT_NEAR(rtn.y() - chief.a * term, row.t, tolerance) << "waypoint " << row.waypoint;
    EXPECT_NEAR(rtn.z(), row.n, tolerance) << "waypoint " << row.waypoint;
  }
}

TEST(Rtn, OfMeanRoeSaysWhyItHasNone) {
  QnsElements chief = mission::kServicerMean;
  chief.i = 0.0;
  EXPECT_EQ(relative_state_from_mean_roe(chief, Vector6::Zero()).status(), Status::kOutOfRange);
  Vector6 roe = Vector6::Zero();
  roe(2) = 0.95;
  EXPECT_EQ(relative_state_from_mean_roe(mission::kServicerMean, roe).status(), Status::kOutOfRange);
  roe(2) = std::nan("");
  EXPECT_EQ(relative_state_from_mean_roe(mission::kServicerMean, roe).status(), Status::kNotFinite);
}

}  // namespace

}  // namespace vbar::fsw::orbit
