#include <cmath>

#include <gtest/gtest.h>

#include "fsw/filter/target_attitude.h"

namespace vbar::fsw::filter {
namespace {

Inertia body(double x, double y, double z) {
  return inertia_of(Vector3(x, y, z).asDiagonal()).value();
}

TEST(PoseAttitude, RodriguesParametersAreThoseOfTheLiterature) {
  // Modified Rodrigues parameters of this quaternion by q_v / (1 + q_4): 0.051884393, -0.103768786, 0.155653180.
  const Eigen::Quaterniond q(0.92736185, 0.1, -0.2, 0.3);
  const Vector3 grp = grp_of(q);
  EXPECT_NEAR(grp.x(), 4.0 * 0.051884393, 4e-9);
  EXPECT_NEAR(grp.y(), 4.0 * -0.103768786, 4e-9);
  EXPECT_NEAR(grp.z(), 4.0 * 0.155653180, 4e-9);
  EXPECT_LT(quaternion_of_grp(grp).angularDistance(q.normalized()), 1e-8);  // q is given to eight digits
  // The other sign is the same turn.
  EXPECT_LT((grp_of(Eigen::Quaterniond(-q.coeffs())) - grp).norm(), 1e-15);
}

TEST(PoseAttitude, RotationVectorsAreEigensAngleTimesAxis) {
  for (const double angle : {1e-9, 0.3, 2.0, 3.1}) {
    const Vector3 axis = Vector3(1.0, -2.0, 0.5).normalized();
    const Eigen::Quaterniond q(Eigen::AngleAxisd(angle, axis));
    EXPECT_LT((rotation_vector_of(q) - angle * axis).norm(), 1e-14);
    EXPECT_LT(quaternion_of_rotation_vector(angle * axis).angularDistance(q), 1e-14);
  }
  EXPECT_EQ(rotation_vector_of(Eigen::Quaterniond::Identity()).norm(), 0.0);
}

TEST(PoseAttitude, ASpinningTopPrecessesAsEulerFound) {
  // Of a body with two equal moments the rate turns about the third axis with (c - a) / a of the spin, in body axes.
  const Inertia top = body(2.0, 2.0, 3.0);
  AttitudeState start;
  start.q_eci_body = Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Vector3(0.3, 0.5, -0.2).normalized()));
  start.rate_body = Vector3(0.01, 0.0, 0.02);
  const double t = 300.0;
  const AttitudeState end = propagate_attitude(start, top, {}, t);
  const double turned = (3.0 - 2.0) / 2.0 * 0.02 * t;
  // Runge-Kutta 4 with 2.5 s: (rate * step)^4 / 120 of the angle turned, 6 rad.
  EXPECT_NEAR(end.rate_body.x(), 0.01 * std::cos(turned), 1e-8);
  EXPECT_NEAR(end.rate_body.y(), 0.01 * std::sin(turned), 1e-8);
  EXPECT_NEAR(end.rate_body.z(), 0.02, 1e-12);
  // And the body about its angular momentum H with |H| / a, about its own axis with the rest.
  const Vector3 h_eci = start.q_eci_body * (top.tensor * start.rate_body);
  const Eigen::Quaterniond about_h(Eigen::AngleAxisd(h_eci.norm() / 2.0 * t, h_eci.normalized()));
  const Eigen::Quaterniond about_z(Eigen::AngleAxisd((1.0 - 3.0 / 2.0) * 0.02 * t, Vector3::UnitZ()));
  EXPECT_LT(end.q_eci_body.angularDistance(about_h * start.q_eci_body * about_z), 1e-6);
}

TEST(PoseAttitude, MomentumOfATumbleStandsInSpaceAndTimeRunsBack) {
  const Inertia tango = body(2.686, 3.458, 3.106);
  AttitudeState start;
  start.rate_body = Vector3(0.01, 0.02, -0.015);
  const AttitudeState end = propagate_attitude(start, tango, {}, 900.0);
  const Vector3 before = start.q_eci_body * (tango.tensor * start.rate_body);
  const Vector3 after = end.q_eci_body * (tango.tensor * end.rate_body);
  EXPECT_LT((after - before).norm() / before.norm(), 2e-6);
  const AttitudeState back = propagate_attitude(end, tango, {}, -900.0);
  EXPECT_LT(back.q_eci_body.angularDistance(start.q_eci_body), 2e-6);
}

TEST(PoseAttitude, GravityTurnsTheLongAxisUp) {
  // u = (1, 1, 0) / root 2 in body axes: u x J u = (J_y - J_x) / 2 about z.
  const Inertia inertia = body(1.0, 2.0, 2.5);
  AttitudeState start;
  start.q_eci_body = Eigen::Quaterniond(Eigen::AngleAxisd(1.1, Vector3(0.2, 0.4, 0.9).normalized()));
  GravityGradient gradient;
  gradient.vertical_eci = start.q_eci_body * Vector3(1.0, 1.0, 0.0).normalized();
  gradient.strength = 3.4e-6;
  const AttitudeState end = propagate_attitude(start, inertia, gradient, 1.0);
  EXPECT_NEAR(end.rate_body.z(), 3.4e-6 * 0.5 / 2.5, 1e-14);
  EXPECT_NEAR(end.rate_body.head<2>().norm(), 0.0, 1e-14);
  // At 7000 km: 3 mu / r^3.
  EXPECT_NEAR(gravity_gradient_at(Vector3(0.0, 7e6, 0.0)).strength, 3.486e-6, 1e-9);
}

TEST(PoseAttitude, RefusesWhatIsNoInertia) {
  EXPECT_EQ(inertia_of(Matrix3::Zero()).status(), Status::kOutOfRange);
  Matrix3 skewed = Matrix3::Identity();
  skewed(0, 1) = 0.1;
  EXPECT_EQ(inertia_of(skewed).status(), Status::kOutOfRange);
  skewed(0, 1) = std::nan("");
  EXPECT_EQ(inertia_of(skewed).status(), Status::kNotFinite);
}

}  // namespace
}  // namespace vbar::fsw::filter
