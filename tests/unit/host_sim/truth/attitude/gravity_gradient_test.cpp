// Gravity-gradient torque and libration against closed forms on a circular orbit.

#include <cmath>

#include <boost/math/special_functions/ellint_1.hpp>
#include <gtest/gtest.h>

#include "host_sim/truth/attitude/gravity_gradient_torque.h"
#include "host_sim/truth/attitude/rigid_body.h"
#include "tests/support/accuracy.h"
#include "tests/unit/host_sim/truth/attitude/circular_orbit.h"

namespace vbar::truth::test {
namespace {

using Eigen::AngleAxisd;
using fsw::Matrix3;
using fsw::Vector3;

// Body axes of the stable equilibrium: x (roll) along the track, y (pitch) against the orbit normal, z (yaw) down, with
// Jy > Jx > Jz.
const Vector3 kMoments(3.2, 3.4, 1.1);

/// Attitude that keeps these axes, turned about the pitch axis by `pitch`, at time 0 of the orbit.
AttitudeState earth_pointing(const CircularOrbit& orbit, double pitch) {
  Matrix3 R_body_eci;
  R_body_eci.row(0) = orbit.velocity(0.0).normalized();
  R_body_eci.row(1) = -orbit.normal();
  R_body_eci.row(2) = -orbit.position(0.0).normalized();
  const Matrix3 turned = AngleAxisd(-pitch, Vector3::UnitY()).toRotationMatrix() * R_body_eci;
  return {Eigen::Quaterniond(turned), {0.0, -orbit.mean_motion(), 0.0}};
}

/// Pitch of an attitude at time t: how far z is from down, about y.
double pitch_of(const AttitudeState& attitude, const CircularOrbit& orbit, double t) {
  const Vector3 down_body = attitude.q_body_eci * -orbit.position(t).normalized();
  return std::atan2(-down_body.x(), down_body.z());
}

RigidBody body_on(const CircularOrbit& orbit, double pitch) {
  std::vector<std::unique_ptr<Torque>> torques;
  torques.push_back(std::make_unique<GravityGradientTorque>(kGm, Matrix3(kMoments.asDiagonal())));
  return {kMoments.asDiagonal(), std::move(torques), orbit, 1e-13, 0.0, earth_pointing(orbit, pitch)};
}

TEST(GravityGradient, IsTheTorqueOfTwoMassesOnARod) {
  // Independent of the tensor formula: Newton's attraction of two masses m at +-l, J = 2 m l^2 across the rod. The
  // tensor formula is the first term of a series in (l/r)^2, and the difference of two attractions loses 7 digits.
  const double m = 50.0, l = 1.0, angle = 0.6;
  const CircularOrbit orbit;
  const ForceInput at = orbit(700.0);
  const Vector3 up = at.position_eci.normalized();
  const Vector3 rod = (std::cos(angle) * up + std::sin(angle) * orbit.normal()).normalized();
  Vector3 expected = Vector3::Zero();
  for (const double side : {-l, l}) {
    const Vector3 place = at.position_eci + side * rod;
    expected += (side * rod).cross(-kGm * m / std::pow(place.norm(), 3) * place);
  }
  // Body x along the rod.
  const Eigen::Quaterniond q_body_eci = Eigen::Quaterniond::FromTwoVectors(rod, Vector3::UnitX());
  GravityGradientTorque torque(kGm, Vector3(0.0, 2.0 * m * l * l, 2.0 * m * l * l).asDiagonal());
  const Vector3 found = q_body_eci.conjugate() * torque.torque_body(at, {q_body_eci, Vector3::Zero()});
  EXPECT_LT((found - expected).norm() / expected.norm(), 1e-7);
}

TEST(GravityGradient, VanishesWithAPrincipalAxisDown) {
  const CircularOrbit orbit;
  GravityGradientTorque torque(kGm, kMoments.asDiagonal());
  // 3 n^2 J is 1e-5 N m; rounding of the attitude leaves 1e-16 of it.
  EXPECT_LT(torque.torque_body(orbit(0.0), earth_pointing(orbit, 0.0)).norm(), 1e-20);
}

TEST(GravityGradient, EarthPointingIsAnEquilibrium) {
  const CircularOrbit orbit;
  RigidBody body = body_on(orbit, 0.0);
  const double end = 2.0 * orbit.period();
  accuracy::Largest largest;
  for (double t = 0.0; t <= end; t += 60.0) {
    body.advance_to(t, t);
    largest.add(std::abs(pitch_of(body.state_at(t), orbit, t)));
  }
  // Steps of the attitude control at 1e-13, some hundred of them; the equilibrium is stable.
  accuracy::expect_below("attitude: gravity-gradient equilibrium, 2 orbits", "stays with the local vertical", largest,
                         1e-11, "rad");
}

TEST(GravityGradient, LibratesWithThePeriodOfThePendulumEquation) {
  // theta'' = -(w0^2 / 2) sin 2 theta, w0^2 = 3 n^2 (Jx - Jz)/Jy (Hughes 2004, section 9.4), is a pendulum in 2 theta:
  // its period is 4 K(sin theta0)/w0, 2 pi/w0 for small swings.
  const CircularOrbit orbit;
  const double n = orbit.mean_motion();
  const double w0 = std::sqrt(3.0 * n * n * (kMoments.x() - kMoments.z()) / kMoments.y());
  for (const double pitch : {1e-3, 0.4}) {
    const double period = 4.0 * boost::math::ellint_1(std::sin(pitch)) / w0;
    RigidBody body = body_on(orbit, pitch);
    for (int k = 1; k <= 400; ++k) body.advance_to(period * k / 400.0, period * k / 400.0);
    const AttitudeState after = body.state_at(period);
    // At the turning point the pitch itself hardly changes with time; the rate about y tells the phase.
    const double rate_error = (after.rate_body.y() + n) / (w0 * pitch);
    EXPECT_NEAR(pitch_of(after, orbit, period) / pitch, 1.0, 1e-8) << pitch;
    accuracy::expect_below(pitch < 0.1 ? "attitude: phase after one gravity-gradient libration of 0.06 deg"
                                       : "attitude: phase after one gravity-gradient libration of 23 deg",
                           "4 K(sin theta0)/sqrt(3 n^2 (Jx - Jz)/Jy)", std::abs(rate_error), 1e-8, "rad");
  }
}

}  // namespace
}  // namespace vbar::truth::test
