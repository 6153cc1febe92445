// Pointing: where the axes point, and that the rate is the attitude's own derivative.

#include "host_sim/truth/attitude/pointing_profile.h"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/support/accuracy.h"
#include "tests/unit/host_sim/truth/attitude/circular_orbit.h"

namespace vbar::truth::test {
namespace {

using Eigen::Quaterniond;
using fsw::Vector3;

/// A motion in closed form that is no orbit: a circle with some terms that tilt and stretch it, so that every
/// derivative counts.
OrbitalMotion wobbling(double t, double phase) {
  const double n = 1.06e-3, k = 2.7e-3, u = n * t + phase;
  const Vector3 a(7.0e6, 0.0, 0.0), b(0.0, 1.0e6, 6.9e6), c(3.0e4, -2.0e4, 5.0e4);
  OrbitalMotion motion;
  motion.position_eci = a * std::cos(u) + b * std::sin(u) + c * std::sin(k * t);
  motion.velocity_eci = n * (-a * std::sin(u) + b * std::cos(u)) + k * c * std::cos(k * t);
  motion.acceleration_eci = -n * n * (a * std::cos(u) + b * std::sin(u)) - k * k * c * std::sin(k * t);
  return motion;
}

OrbitalMotion own(double t) {
  return wobbling(t, 0.3);
}
OrbitalMotion other(double t) {
  OrbitalMotion motion = wobbling(t, 0.3 + 1e-5);
  motion.position_eci += Vector3(2.0, -3.0, 1.0);
  return motion;
}

/// Once round in a year, at 1 au.
Vector3 sun(double t) {
  const double u = 1.99e-7 * t + 2.0;
  return 1.496e11 * Vector3(std::cos(u), 0.917 * std::sin(u), 0.398 * std::sin(u));
}

Vector3 unit_direction(Direction direction, double t) {
  const OrbitalMotion at = own(t);
  const Vector3 r = at.position_eci, h = r.cross(at.velocity_eci);
  switch (direction) {
    case Direction::kZenith:
      return r.normalized();
    case Direction::kNadir:
      return -r.normalized();
    case Direction::kAlongTrack:
      return h.cross(r).normalized();
    case Direction::kOrbitNormal:
      return h.normalized();
    case Direction::kSun:
      return (sun(t) - r).normalized();
    case Direction::kSpacecraft:
      return (other(t).position_eci - r).normalized();
  }
  return Vector3::Zero();
}

struct Case {
  const char* name;
  Direction boresight, second;
};
constexpr Case kCases[] = {{"Zenith", Direction::kZenith, Direction::kOrbitNormal},
                           {"ZenithToSun", Direction::kZenith, Direction::kSun},
                           {"Nadir", Direction::kNadir, Direction::kAlongTrack},
                           {"AlongTrack", Direction::kAlongTrack, Direction::kZenith},
                           {"Sun", Direction::kSun, Direction::kOrbitNormal},
                           {"Spacecraft", Direction::kSpacecraft, Direction::kOrbitNormal},
                           {"SpacecraftToSun", Direction::kSpacecraft, Direction::kSun}};

const Vector3 kBoresight(0.1, -0.3, 2.0), kSecond(0.2, 1.0, 0.4);

PointingProfile profile(const Case& c) {
  return {{c.boresight, kBoresight, c.second, kSecond}, own, other, sun};
}

double angle(const Vector3& a, const Vector3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

TEST(PointingProfile, TurnsTheBoresightThereAndTheSecondAxisAsNearAsItGoes) {
  accuracy::Largest boresight_error;
  for (const Case& c : kCases) {
    const PointingProfile pointing = profile(c);
    for (double t = 0.0; t < 6000.0; t += 97.0) {
      const Quaterniond q_eci_body = pointing.state_at(t).q_body_eci.conjugate();
      const Vector3 to = unit_direction(c.boresight, t), second_to = unit_direction(c.second, t);
      boresight_error.add(angle(q_eci_body * kBoresight, to));
      // As near as it goes: the second axis, the boresight and the wanted direction lie in one plane, on one side.
      const Vector3 second = q_eci_body * kSecond.normalized();
      EXPECT_NEAR(second.dot(to.cross(second_to).normalized()), 0.0, 1e-13) << c.name;
      EXPECT_GT((second - to * to.dot(second)).dot(second_to), 0.0) << c.name;
    }
  }
  // Rounding of a quaternion and two rotations.
  accuracy::expect_below("attitude: boresight of pointing profiles", "direction from the orbits, 434 instants",
                         boresight_error, 1e-12, "rad");
}

/// Largest difference of the rate of a profile and its differenced attitude, over some 60 instants.
double rate_error(const Case& c) {
  const PointingProfile pointing = profile(c);
  accuracy::Largest error;
  for (double t = 0.0; t < 6000.0; t += 97.0) {
    // Rotation vector from -h to +h over 2 h, extrapolated (Richardson): error h^4, and the attitude's rounding over h.
    const auto differenced = [&](double h) -> Vector3 {
      const Quaterniond turn = pointing.state_at(t + h).q_body_eci * pointing.state_at(t - h).q_body_eci.conjugate();
      const Eigen::AngleAxisd rotation(turn);
      return -rotation.angle() / (2.0 * h) * rotation.axis();
    };
    const Vector3 rate = (4.0 * differenced(0.5) - differenced(1.0)) / 3.0;
    error.add((pointing.state_at(t).rate_body - rate).norm());
  }
  return error;
}

TEST(PointingProfile, RateIsTheDerivativeOfTheAttitude) {
  accuracy::Largest at_infinity, at_spacecraft;
  for (const Case& c : kCases) {
    accuracy::Largest& largest = c.boresight == Direction::kSpacecraft ? at_spacecraft : at_infinity;
    largest.add(rate_error(c));
  }
  // The attitude is rounded to some 1e-15 rad; a direction to a point 70 m away to 2e-11 rad, by positions of 7e6 m.
  accuracy::expect_below("attitude: rate of pointing at zenith, nadir, along the track, the Sun",
                         "differenced attitude, 310 instants", at_infinity, 2e-14, "rad/s");
  accuracy::expect_below("attitude: rate of pointing at a spacecraft 70 m away", "differenced attitude, 124 instants",
                         at_spacecraft, 1e-10, "rad/s");
}

TEST(PointingProfile, ZenithOnACircularOrbitTurnsOnceAnOrbit) {
  const CircularOrbit orbit;
  const double n = orbit.mean_motion();
  const auto motion = [&](double t) {
    return OrbitalMotion{orbit.position(t), orbit.velocity(t), -n * n * orbit.position(t)};
  };
  const PointingProfile pointing({}, motion, {}, {});  // z to the zenith, y to the orbit normal
  const AttitudeState attitude = pointing.state_at(1234.0);
  EXPECT_LT((attitude.rate_body - Vector3(0.0, n, 0.0)).norm(), 1e-15 * n + 1e-18);
  EXPECT_LT((attitude.q_body_eci * orbit.normal() - Vector3::UnitY()).norm(), 1e-14);
}

TEST(PointingProfile, SaysWhereTheTurnAboutTheBoresightIsLost) {
  // The other spacecraft straight along the orbit normal.
  const auto above = [](double t) {
    OrbitalMotion motion = own(t);
    motion.position_eci += 100.0 * motion.position_eci.cross(motion.velocity_eci).normalized();
    return motion;
  };
  const PointingSettings settings{Direction::kSpacecraft, kBoresight, Direction::kOrbitNormal, kSecond};
  const PointingProfile parallel(settings, own, above, {});
  EXPECT_THROW(static_cast<void>(parallel.state_at(10.0)), std::domain_error);
  // And a spacecraft at the same place.
  const PointingProfile coincident(settings, own, own, {});
  EXPECT_THROW(static_cast<void>(coincident.state_at(10.0)), std::domain_error);
}

TEST(PointingProfile, RefusesSettingsThatDetermineNoAttitude) {
  const auto make = [](const PointingSettings& s) { return PointingProfile(s, own, other, sun); };
  EXPECT_NO_THROW(make({}));
  EXPECT_THROW(make({.second_body = -3.0 * Vector3::UnitZ()}), std::invalid_argument);
  EXPECT_THROW(make({.boresight_body = Vector3::Zero()}), std::invalid_argument);
  EXPECT_THROW(make({.boresight_body = Vector3::Constant(std::numeric_limits<double>::quiet_NaN())}),
               std::invalid_argument);
  EXPECT_THROW(make({.boresight_to = Direction::kNadir, .second_to = Direction::kZenith}), std::invalid_argument);
  EXPECT_THROW(PointingProfile({.boresight_to = Direction::kSpacecraft}, own, {}, sun), std::invalid_argument);
  EXPECT_THROW(PointingProfile({.second_to = Direction::kSun}, own, other, {}), std::invalid_argument);
  EXPECT_THROW(PointingProfile({}, {}, other, sun), std::invalid_argument);
}

TEST(InertialAttitude, StaysAndDoesNotTurn) {
  const InertialAttitude attitude(Quaterniond(2.0, 0.0, 0.0, 2.0));
  EXPECT_LT(angle_between(attitude.state_at(1e5).q_body_eci, Quaterniond(std::sqrt(0.5), 0.0, 0.0, std::sqrt(0.5))),
            1e-15);
  EXPECT_EQ(attitude.state_at(1e5).rate_body, Vector3::Zero());
}

}  // namespace
}  // namespace vbar::truth::test
