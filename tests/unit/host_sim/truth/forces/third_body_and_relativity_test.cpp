#include <array>
#include <cmath>
#include <functional>

#include <Eigen/Geometry>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/numeric/odeint.hpp>
#include <gtest/gtest.h>

#include "host_sim/truth/earth/sun_moon.h"
#include "host_sim/truth/forces/gravitation.h"
#include "tests/support/accuracy.h"
#include "tests/unit/host_sim/truth/truth_fixtures.h"

namespace vbar::truth {

namespace {

using fsw::Vector3;
using Wide = boost::multiprecision::cpp_bin_float_50;

const Vector3 kSun(-0.4 * kAstronomicalUnit, 0.85 * kAstronomicalUnit, 0.37 * kAstronomicalUnit);
const Vector3 kMoon(2.9e8, -2.2e8, 1.1e8);
const Vector3 kDirections[] = {{1, 0, 0}, {0, -1, 0}, {0.3, 0.5, -0.7}, {-0.6, 0.1, 0.8}, {2.9, -2.2, 1.1}};

/// The definition: attraction of the spacecraft less that of the Earth, in 50 digits.
Vector3 direct_difference(const Vector3& position, const Vector3& body, double gm) {
  Wide to_body[3], distance2 = 0, body2 = 0;
  for (int i = 0; i < 3; ++i) {
    to_body[i] = Wide(body[i]) - Wide(position[i]);
    distance2 += to_body[i] * to_body[i];
    body2 += Wide(body[i]) * Wide(body[i]);
  }
  const Wide near = Wide(gm) / (distance2 * sqrt(distance2)), far = Wide(gm) / (body2 * sqrt(body2));
  Vector3 difference;
  for (int i = 0; i < 3; ++i) difference[i] = static_cast<double>(near * to_body[i] - far * Wide(body[i]));
  return difference;
}

TEST(ThirdBody, IsTheDirectDifferenceWithoutItsCancellation) {
  // A few roundings of doubles, 1e-15; along directions where the tide's two terms compensate each other, some more.
  accuracy::Largest largest;
  for (const auto& [body, gm] : {std::pair{kSun, kSunGm}, {kMoon, kMoonGm}}) {
    for (const Vector3& direction : kDirections) {
      for (double distance : {1.0, 6.4e6, 7.1e6, 4.2e7, 1.5e8}) {
        const Vector3 position = distance * direction.normalized();
        const Vector3 expected = direct_difference(position, body, gm);
        largest.add((third_body_acceleration(position, body, gm) - expected).norm() / expected.norm());
      }
    }
  }
  accuracy::expect_below("attraction of Sun and Moon", "direct difference in 50 digits, 1 m to 150,000 km", largest,
                         3e-15, "relative");
}

TEST(ThirdBody, IsATideNearTheEarth) {
  // First order in position: GM / d^3 (3 (r . s) s - r); the next order is smaller by 1.5 r / d at most per unit of the
  // tide along s, so 3 r / d bounds it whatever the direction.
  for (const auto& [body, gm] : {std::pair{kSun, kSunGm}, {kMoon, kMoonGm}}) {
    const double d = body.norm();
    const Vector3 s = body / d;
    for (const Vector3& direction : kDirections) {
      const Vector3 r = 7.1e6 * direction.normalized();
      const Vector3 tide = gm / (d * d * d) * (3.0 * r.dot(s) * s - r);
      EXPECT_LT((third_body_acceleration(r, body, gm) - tide).norm(), 3.0 * 7.1e6 / d * tide.norm());
    }
  }
}

TEST(ThirdBody, TakesItsBodyFromTheInput) {
  ForceInput input;
  input.position_eci = Vector3(7.1e6, 1e6, -2e6);
  input.sun_eci = kSun;
  input.moon_eci = kMoon;
  ThirdBodyForce sun(ThirdBodyForce::Body::kSun), moon(ThirdBodyForce::Body::kMoon);
  EXPECT_EQ(sun.acceleration_eci(input), third_body_acceleration(input.position_eci, kSun, kSunGm));
  EXPECT_EQ(moon.acceleration_eci(input), third_body_acceleration(input.position_eci, kMoon, kMoonGm));
  EXPECT_EQ(sun.name(), "sun");
  EXPECT_EQ(moon.name(), "moon");
  EXPECT_TRUE(sun.needs_sun_and_moon() && moon.needs_sun_and_moon());
  // The Moon's tide on the Earth is 2.2 times the Sun's (Newton's tides): the parameters belong to the right bodies.
  const double moon_tide = kMoonGm / std::pow(384400e3, 3), sun_tide = kSunGm / std::pow(kAstronomicalUnit, 3);
  EXPECT_NEAR(moon_tide / sun_tide, 2.18, 0.01);
}

}  // namespace

namespace {

using fsw::Vector6;
using fsw::orbit::CartesianState;
using test::kGm;

using Perturbation = std::function<Vector3(const Vector3& position, const Vector3& velocity)>;

constexpr double kA = 1.2e7, kE = 0.3, kI = 1.0, kC = 299792458.0, kJ = 9.8e8;
const double kPeriod = 2.0 * M_PI * std::sqrt(kA * kA * kA / kGm);

/// Angles of an orbit's plane and perigee, by their definitions.
struct Angles {
  double node, perigee;
};

Angles angles(const CartesianState& s) {
  const Vector3 h = s.position_eci.cross(s.velocity_eci);
  const Vector3 e = s.velocity_eci.cross(h) / kGm - s.position_eci.normalized();
  const Vector3 node = Vector3::UnitZ().cross(h).normalized();
  return {std::atan2(node.y(), node.x()), std::atan2(h.normalized().cross(node).dot(e), node.dot(e))};
}

CartesianState start() {
  CartesianState s;
  const double r = kA * (1.0 - kE), v = std::sqrt(kGm / kA * (1.0 + kE) / (1.0 - kE));
  const Eigen::AngleAxisd tilt(kI, Vector3::UnitX());
  const Eigen::AngleAxisd perigee(0.7, tilt * Vector3::UnitZ());
  s.position_eci = perigee * (tilt * Vector3(r, 0.0, 0.0));
  s.velocity_eci = perigee * (tilt * Vector3(0.0, v, 0.0));
  return s;
}

/// How far node and perigee have moved an orbit, over ten orbits, by Cartesian integration (Fehlberg 7(8)).
Angles advance_per_orbit(const Perturbation& perturbation) {
  using State = std::array<double, 6>;
  using Stepper = boost::numeric::odeint::runge_kutta_fehlberg78<State>;
  static const Stepper stepper;
  const CartesianState first = start();
  State y{};
  for (std::size_t i = 0; i < 3; ++i) {
    y[i] = first.position_eci[static_cast<int>(i)];
    y[i + 3] = first.velocity_eci[static_cast<int>(i)];
  }
  const auto rates = [&](const State& state, State& rate, double) {
    const Vector3 r(state[0], state[1], state[2]), v(state[3], state[4], state[5]);
    const Vector3 a = perturbation(r, v) - kGm / std::pow(r.norm(), 3) * r;
    rate = {v.x(), v.y(), v.z(), a.x(), a.y(), a.z()};
  };
  constexpr int kOrbits = 10;
  boost::numeric::odeint::integrate_adaptive(boost::numeric::odeint::make_controlled(0.0, 1e-14, stepper), rates, y,
                                             0.0, kOrbits * kPeriod, 10.0);
  const CartesianState last{{y[0], y[1], y[2]}, {y[3], y[4], y[5]}};
  return {std::remainder(angles(last).node - angles(first).node, 2.0 * M_PI) / kOrbits,
          std::remainder(angles(last).perigee - angles(first).perigee, 2.0 * M_PI) / kOrbits};
}

// Integration leaves 1e-14 of a revolution or so an orbit; Schwarzschild's advance is 1e-8, Lense's and Thirring's
// 1e-10. An unperturbed integration measures it.
Angles numerical_advance() {
  static const Angles value = advance_per_orbit([](const Vector3&, const Vector3&) { return Vector3::Zero().eval(); });
  return value;
}

TEST(Relativity, PerigeeAdvancesAsEinsteinSays) {
  const Angles found =
      advance_per_orbit([](const Vector3& r, const Vector3& v) { return schwarzschild_acceleration(kGm, r, v); });
  const double expected = 6.0 * M_PI * kGm / (kC * kC * kA * (1.0 - kE * kE));
  ASSERT_LT(std::abs(numerical_advance().perigee), 1e-5 * expected);
  accuracy::expect_below("relativity: advance of the perigee", "Einstein 1915, 6 pi GM / (c^2 a (1 - e^2)) an orbit",
                         std::abs(found.perigee / expected - 1.0), 2e-5, "relative");  // the integration's share, twice
  EXPECT_LT(std::abs(found.node), 1e-5 * expected);
}

TEST(Relativity, NodeAndPerigeeAreDraggedAsLenseAndThirringSay) {
  const Angles found = advance_per_orbit(
      [](const Vector3& r, const Vector3& v) { return lense_thirring_acceleration(kGm, Vector3::UnitZ(), r, v); });
  const double rate = 2.0 * kGm * kJ / (kC * kC * std::pow(kA, 3) * std::pow(1.0 - kE * kE, 1.5));
  ASSERT_LT(std::abs(numerical_advance().node), 1e-4 * rate * kPeriod);
  accuracy::expect_below("relativity: dragging of the node",
                         "Lense and Thirring 1918, 2 G J / (c^2 a^3 (1 - e^2)^(3/2))",
                         std::abs(found.node / (rate * kPeriod) - 1.0), 1e-3, "relative");  // the integration's noise
  EXPECT_NEAR(found.perigee / (-3.0 * std::cos(kI) * rate * kPeriod), 1.0, 1e-2);  // the same of a perigee, which is
                                                                                   // determined worse by 1/e
}

TEST(Relativity, DeSittersPrecessionIsNineteenMilliarcsecondsAYear) {
  // The local frame turns about the ecliptic's pole by 19.19 mas a year (de Sitter 1916; IERS Conventions 2010, ch. 10:
  // 1.92" a century), so that free motion is subject to 2 Omega x v in the frame of fixed stars.
  constexpr double kMasPerYear = M_PI / 180.0 / 3.6e6 / (365.25 * 86400.0);
  const double obliquity = 23.4393 * test::kDegree;
  const Vector3 pole(0.0, -std::sin(obliquity), std::cos(obliquity)), v(1000.0, 7000.0, -2000.0);
  const Vector3 expected = 2.0 * 19.19 * kMasPerYear * pole.cross(v);
  // Half a printed digit of 19.19, and the eccentricity's square, 3e-4, between distance a and the mean over time.
  EXPECT_LT((de_sitter_acceleration(149597870700.0, v) - expected).norm(), 6e-4 * expected.norm());
}

TEST(Relativity, SizesInALowOrbit) {
  // As stated: 2e-8, 2e-10, 4e-11 m/s^2, to the printed digit.
  const Vector3 r(6.85e6, 0.0, 0.0), v(0.0, 0.0, 7628.0);
  EXPECT_NEAR(schwarzschild_acceleration(kGm, r, v).norm(), 2e-8, 0.8e-8);
  EXPECT_NEAR(lense_thirring_acceleration(kGm, Vector3::UnitZ(), r, Vector3(0.0, 7628.0, 0.0)).norm(), 2e-10, 0.5e-10);
  EXPECT_NEAR(de_sitter_acceleration(1.5e11, Vector3(7628.0, 0.0, 0.0)).norm(), 4e-11, 0.6e-11);
}

TEST(Relativity, TheForceIsTheSumOfTheThree) {
  RelativityForce force(kGm);
  ForceInput input;
  input.position_eci = start().position_eci;
  input.velocity_eci = start().velocity_eci;
  input.R_itrf_gcrf = Eigen::AngleAxisd(0.002, Vector3::UnitX()).toRotationMatrix();  // the pole some years from J2000
  input.sun_eci = Vector3(1.2e11, 0.7e11, 0.3e11);
  const Vector3 spin = input.R_itrf_gcrf.transpose() * Vector3::UnitZ();
  const Vector3 expected = schwarzschild_acceleration(kGm, input.position_eci, input.velocity_eci) +
                           lense_thirring_acceleration(kGm, spin, input.position_eci, input.velocity_eci) +
                           de_sitter_acceleration(input.sun_eci.norm(), input.velocity_eci);
  EXPECT_LT((force.acceleration_eci(input) - expected).norm(), 1e-15 * expected.norm());  // rounding
  EXPECT_TRUE(force.needs_sun_and_moon());
}

}  // namespace

}  // namespace vbar::truth
