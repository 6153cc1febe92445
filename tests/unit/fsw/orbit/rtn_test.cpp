// The RTN frame and the exact relative state of mean ROE.

#include "fsw/orbit/rtn.h"

#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "fsw/orbit/mean_osculating.h"
#include "fsw/orbit/roe.h"
#include "fsw/orbit/secular.h"
#include "tests/support/figures.h"
#include "tests/unit/fsw/orbit/longitude_term.h"
#include "tests/unit/fsw/orbit/mission.h"
#include "tests/unit/fsw/orbit/reference_orbit.h"

namespace vbar::fsw::orbit {
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
