// Gravity-gradient torque and libration against closed forms on a circular orbit.

#include "host_sim/truth/attitude/torques.h"

#include <cmath>
#include <stdexcept>

#include <boost/math/special_functions/ellint_1.hpp>
#include <gtest/gtest.h>

#include "host_sim/truth/attitude/rigid_body.h"
#include "tests/support/accuracy.h"
#include "tests/unit/host_sim/truth/truth_fixtures.h"

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

// Torques of air and sunlight on facets, by hand.

namespace {

using Eigen::Quaterniond;

constexpr double kAu_m = 149597870700.0;
constexpr double kPressure_Npm2 = 1361.0 / 299792458.0;  // W/m^2 at 1 au (IAU 2015 B3) over the speed of light
constexpr double kRounding = 1e-14;                      // relative, of some tens of operations

/// A box with the given edges, its geometrical centre at `centre` from the centre of mass.
std::vector<Facet> box(const Vector3& edges, const Vector3& centre, double specular = 0.0, double diffuse = 0.0) {
  std::vector<Facet> facets;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      Vector3 normal = Vector3::Zero();
      normal[axis] = side;
      const double area = edges.prod() / edges[axis];
      facets.push_back({area, centre + 0.5 * side * edges[axis] * Vector3::Unit(axis), normal, specular, diffuse});
    }
  }
  return facets;
}

const Vector3 kEdges(0.74, 0.67, 0.32);

/// Attitudes on all sides of a box.
std::vector<Quaterniond> many_attitudes() {
  std::vector<Quaterniond> attitudes;
  for (int k = 0; k < 200; ++k) {
    const double s = k;
    attitudes.push_back(
        Quaterniond(std::sin(s), std::cos(1.7 * s), std::sin(2.3 * s + 1.0), std::cos(3.1 * s)).normalized());
  }
  return attitudes;
}

class ConstantAir final : public Air {
 public:
  double density(const ForceInput&) override { return 3e-13; }
};

AerodynamicTorque aerodynamic(std::vector<Facet> facets) {
  return {std::move(facets), 2.25, std::make_unique<ConstantAir>()};
}

TEST(AerodynamicTorque, VelocityIsThatThroughTurningAir) {
  // On the equator the air moves east at the rate of the Earth rotation angle, 2 pi 1.00273781191135448 / 86400 s (IERS
  // Conventions 2010, eq. 5.15), times the radius.
  ForceInput orbit;
  orbit.position_eci = {7e6, 0.0, 0.0};
  orbit.velocity_eci = {0.0, 0.0, 7500.0};
  EXPECT_LT(
      (velocity_through_air_eci(orbit) - Vector3(0.0, -7e6 * kTwoPi * 1.00273781191135448 / 86400.0, 7500.0)).norm(),
      1e-9);
}

TEST(AerodynamicTorque, OfASymmetricBoxAboutItsCentreIsNone) {
  AerodynamicTorque torque = aerodynamic(box(kEdges, Vector3::Zero()));
  const ForceInput orbit = CircularOrbit{}(100.0);
  for (const Quaterniond& q : many_attitudes()) {
    // Each facet alone has some 1e-6 N m.
    EXPECT_LT(torque.torque_body(orbit, {q, Vector3::Zero()}).norm(), 1e-20);
  }
}

TEST(AerodynamicTorque, OfABoxOffItsCentreIsArmTimesForce) {
  // The force of a Newtonian stream is -1/2 rho C_D v^2 along the flow times the projected area, that of three faces,
  // and acts on the centre of the box.
  const Vector3 centre(0.01, -0.04, 0.15);
  AerodynamicTorque torque = aerodynamic(box(kEdges, centre));
  const ForceInput orbit = CircularOrbit{}(100.0);
  const Vector3 velocity = velocity_through_air_eci(orbit);
  for (const Quaterniond& q : many_attitudes()) {
    const Vector3 v = q * velocity;
    const Vector3 flow = v.normalized().cwiseAbs();
    const double area = flow.x() * 0.67 * 0.32 + flow.y() * 0.74 * 0.32 + flow.z() * 0.74 * 0.67;
    const Vector3 expected = centre.cross(-0.5 * 3e-13 * 2.25 * v.norm() * area * v);
    EXPECT_LT((torque.torque_body(orbit, {q, Vector3::Zero()}) - expected).norm(), 1e-13 * expected.norm() + 1e-20);
  }
}

/// Half of the Sun, always.
class HalfSun final : public Sunlight {
 public:
  double fraction(const ForceInput&) const override { return 0.5; }
};

class FullSun final : public Sunlight {
 public:
  double fraction(const ForceInput&) const override { return 1.0; }
};

/// The Sun on the x axis at a distance of `au`.
ForceInput sun_on_x(double au) {
  ForceInput orbit;
  orbit.sun_eci = {au * kAu_m, 0.0, 0.0};
  return orbit;
}

/// A plate of 2 m^2 that faces +x, 3 m out on +y: a push of F along -x has the torque 3 F about +z.
Facet plate(double specular, double diffuse) {
  return {2.0, {0.0, 3.0, 0.0}, Vector3::UnitX(), specular, diffuse};
}

template <class Light = FullSun>
Vector3 torque_of_plate(const Facet& facet, const ForceInput& orbit, const Quaterniond& q = Quaterniond::Identity()) {
  return RadiationTorque({facet}, std::make_unique<Light>()).torque_body(orbit, {q, Vector3::Zero()});
}

TEST(RadiationTorque, OfPlatesThatFaceTheSun) {
  // Momentum balance: what is absorbed pushes once, what is mirrored twice, what is scattered by Lambert's law 5/3
  // times.
  const double absorbed = kPressure_Npm2 * 2.0 * 3.0;
  const auto expect = [&](double factor, const Vector3& torque) {
    EXPECT_LT((torque - Vector3(0.0, 0.0, factor * absorbed)).norm(), kRounding * absorbed);
  };
  expect(1.0, torque_of_plate(plate(0.0, 0.0), sun_on_x(1.0)));
  expect(2.0, torque_of_plate(plate(1.0, 0.0), sun_on_x(1.0)));
  expect(5.0 / 3.0, torque_of_plate(plate(0.0, 1.0), sun_on_x(1.0)));
  expect(0.25, torque_of_plate(plate(0.0, 0.0), sun_on_x(2.0)));
  expect(0.5, torque_of_plate<HalfSun>(plate(0.0, 0.0), sun_on_x(1.0)));
}

TEST(RadiationTorque, OfPlatesAtAnAngle) {
  // The Sun 60 deg off the normal, in the x-z plane of the body: half the area, and a mirror's push only along its
  // normal.
  const double angle = kTwoPi / 6.0;
  const Quaterniond q(Eigen::AngleAxisd(-angle, Vector3::UnitY()));
  const Vector3 s(0.5, 0.0, std::sqrt(3.0) / 2.0);
  ASSERT_LT((q * Vector3::UnitX() - s).norm(), 1e-15);
  const Vector3 arm(0.0, 3.0, 0.0);
  const Vector3 absorbed = arm.cross(-kPressure_Npm2 * 2.0 * 0.5 * s);
  const Vector3 mirrored = arm.cross(-kPressure_Npm2 * 2.0 * 2.0 * 0.25 * Vector3::UnitX());
  EXPECT_LT((torque_of_plate(plate(0.0, 0.0), sun_on_x(1.0), q) - absorbed).norm(), kRounding * absorbed.norm());
  EXPECT_LT((torque_of_plate(plate(1.0, 0.0), sun_on_x(1.0), q) - mirrored).norm(), kRounding * absorbed.norm());
}

TEST(RadiationTorque, OfAPlateThatFacesAwayIsNone) {
  EXPECT_EQ(torque_of_plate(plate(0.5, 0.1), sun_on_x(1.0), Quaterniond(0.0, 0.0, 1.0, 0.0)), Vector3::Zero());
}

TEST(RadiationTorque, OfASymmetricBoxAboutItsCentreIsNone) {
  RadiationTorque torque(box(kEdges, Vector3::Zero(), 0.3, 0.2), std::make_unique<FullSun>());
  for (const Quaterniond& q : many_attitudes()) {
    // Each facet alone has some 1e-6 N m.
    EXPECT_LT(torque.torque_body(sun_on_x(1.0), {q, Vector3::Zero()}).norm(), 1e-20);
  }
}

TEST(SurfaceTorques, NeedASurface) {
  EXPECT_THROW(aerodynamic({}), std::invalid_argument);
  EXPECT_THROW(AerodynamicTorque(box(kEdges, Vector3::Zero()), 2.0, nullptr), std::invalid_argument);
  EXPECT_THROW(RadiationTorque({}, std::make_unique<FullSun>()), std::invalid_argument);
  EXPECT_THROW(RadiationTorque(box(kEdges, Vector3::Zero()), nullptr), std::invalid_argument);
}

TEST(FacetOfPolygon, HasAreaCentroidAndNormal) {
  // A right trapezoid with parallel sides 1 and 3 m and height 2 m, in the plane z = 5: area 4, centroid by the
  // textbook formulas x = (a^2 + a b + b^2)/(3 (a + b)) = 13/12, y = h (2 a + b)/(3 (a + b)) = 5/6 from the longer
  // side.
  const Facet facet = facet_of_polygon({{0.0, 0.0, 5.0}, {3.0, 0.0, 5.0}, {1.0, 2.0, 5.0}, {0.0, 2.0, 5.0}}, 0.1, 0.2);
  EXPECT_NEAR(facet.area_m2, 4.0, 1e-15);
  EXPECT_LT((facet.centre_m - Vector3(13.0 / 12.0, 5.0 / 6.0, 5.0)).norm(), 1e-14);
  EXPECT_LT((facet.normal - Vector3::UnitZ()).norm(), 1e-15);
  EXPECT_EQ(facet.specular, 0.1);
  EXPECT_EQ(facet.diffuse, 0.2);
}

TEST(FacetOfPolygon, RefusesWhatIsNone) {
  const Vector3 a(0.0, 0.0, 0.0), b(1.0, 0.0, 0.0), c(1.0, 1.0, 0.0), off(0.0, 1.0, 0.1);
  EXPECT_THROW(facet_of_polygon({a, b}, 0.0, 0.0), std::invalid_argument);
  EXPECT_THROW(facet_of_polygon({a, b, 2.0 * b}, 0.0, 0.0), std::invalid_argument);
  EXPECT_THROW(facet_of_polygon({a, b, c, off}, 0.0, 0.0), std::invalid_argument);
  EXPECT_THROW(facet_of_polygon({a, b, c}, 0.7, 0.4), std::invalid_argument);
  EXPECT_THROW(facet_of_polygon({a, b, c}, -0.1, 0.4), std::invalid_argument);
}

}  // namespace

}  // namespace vbar::truth::test
