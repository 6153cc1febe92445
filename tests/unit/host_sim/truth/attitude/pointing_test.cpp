// Pointing: where the axes point, and that the rate is the attitude's own derivative.

#include <cmath>
#include <limits>
#include <stdexcept>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "fsw/orbit/rtn.h"
#include "host_sim/truth/attitude/commanded_attitude.h"
#include "host_sim/truth/attitude/pointing_profile.h"
#include "host_sim/truth/truth_model.h"
#include "tests/support/accuracy.h"
#include "tests/unit/host_sim/truth/truth_fixtures.h"

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

// Commanded pointing: where the boresight goes in RTN, that rates are the attitude's own derivative, and what a command
// may not do.

namespace {

constexpr double kArcsecond = kDegree / 3600.0;

/// A motion in closed form that is no orbit: a circle with a term that tilts and stretches it.
OrbitalMotion own_at(double t) {
  const double n = 1.06e-3, k = 2.7e-3, u = n * t + 0.3;
  const Vector3 a(7.0e6, 0.0, 0.0), b(0.0, 1.0e6, 6.9e6), c(3.0e4, -2.0e4, 5.0e4);
  OrbitalMotion motion;
  motion.position_eci = a * std::cos(u) + b * std::sin(u) + c * std::sin(k * t);
  motion.velocity_eci = n * (-a * std::sin(u) + b * std::cos(u)) + k * c * std::cos(k * t);
  motion.acceleration_eci = -n * n * (a * std::cos(u) + b * std::sin(u)) - k * k * c * std::sin(k * t);
  return motion;
}

Vector3 in_rtn(double t, const Vector3& v_eci) {
  return fsw::orbit::R_rtn_eci({own_at(t).position_eci, own_at(t).velocity_eci}) * v_eci;
}

/// Large and quick enough that terms of second order count: some arc minutes within a minute.
ControlError some_error() {
  ControlError error{};
  error[0][0] = {400.0 * kArcsecond, 0.11, 0.4};
  error[0][1] = {90.0 * kArcsecond, 0.31, 1.9};
  error[1][0] = {300.0 * kArcsecond, 0.07, 2.0};
  error[2][4] = {500.0 * kArcsecond, 0.19, -1.0};
  return error;
}

TEST(CommandedAttitude, FollowsTheLineInRtnWithTheSecondAxisUp) {
  CommandedAttitude attitude({}, {}, own_at);
  const Vector3 boresight = Vector3(0.05, -1.0, 0.02).normalized(), rate(1e-4, 0.0, -2e-4);
  ASSERT_TRUE(attitude.take({100.0, boresight, rate}));
  for (const double t : {0.0, 99.9, 100.0, 130.0, 700.0, 800.0, 5000.0}) {
    const double led_s = std::min(t - 100.0, 600.0);  // the line ends after ten minutes
    const Vector3 wanted = t < 100.0 ? Vector3(0.0, -1.0, 0.0) : Vector3(boresight + led_s * rate).normalized();
    const Quaterniond q_eci_body = attitude.state_at(t).q_body_eci.conjugate();
    EXPECT_LT((in_rtn(t, q_eci_body * Vector3::UnitZ()) - wanted).norm(), 1e-14) << t;
    // -y up: towards the zenith as far as the boresight lets it.
    const Vector3 up = in_rtn(t, q_eci_body * -Vector3::UnitY());
    EXPECT_NEAR(up.dot(wanted.cross(Vector3::UnitX())), 0.0, 1e-14) << t;
    EXPECT_GT(up.x(), 0.9) << t;
  }
}

TEST(CommandedAttitude, RateIsTheDerivativeOfTheAttitude) {
  CommandedAttitude attitude({.boresight_body = {0.1, -0.3, 2.0}, .second_body = {0.2, -1.0, 0.4}}, some_error(),
                             own_at);
  ASSERT_TRUE(attitude.take({0.0, Vector3(0.1, -0.9, 0.3).normalized(), {2e-4, 1e-4, -3e-4}}));
  accuracy::Largest largest;
  for (double t = 5.0; t < 2000.0; t += 33.7) {
    if (std::abs(t - kLongestLine_s) < 2.0) continue;  // there the line ends, and the rate jumps
    // Rotation vector from -h to +h over 2 h, extrapolated (Richardson).
    const auto differenced = [&](double h) -> Vector3 {
      const Eigen::AngleAxisd turn(attitude.state_at(t + h).q_body_eci *
                                   attitude.state_at(t - h).q_body_eci.conjugate());
      return -turn.angle() / (2.0 * h) * turn.axis();
    };
    const Vector3 rate = (4.0 * differenced(0.25) - differenced(0.5)) / 3.0;
    largest.add((attitude.state_at(t).rate_body - rate).norm());
  }
  // Errors of 2e-3 rad at 0.3 rad/s: h^4 w^5 A / 30 is 1e-9 rad/s for the fastest sinusoid (4.4e-4 rad).
  accuracy::expect_below("attitude: rate of commanded pointing with control errors",
                         "differenced attitude, 60 instants", largest, 2e-9, "rad/s");
}

TEST(CommandedAttitude, ErrorTurnsTheBodyAboutItsOwnAxes) {
  ControlError error{};
  error[2][0] = {0.001, 0.0, 3.14159265358979323846 / 2.0};  // a constant milliradian about the boresight
  const CommandedAttitude with({}, error, own_at), without({}, {}, own_at);
  const Quaterniond turn = with.state_at(50.0).q_body_eci * without.state_at(50.0).q_body_eci.conjugate();
  // Body axes that have turned by +angle about z see what is still turned by -angle.
  EXPECT_LT((turn * Vector3::UnitX() - Vector3(std::cos(0.001), -std::sin(0.001), 0.0)).norm(), 1e-14);
}

TEST(CommandedAttitude, LaterCommandsReplaceThoseThatHaveNotBegun) {
  CommandedAttitude attitude({}, {}, own_at);
  const auto boresight = [&](double t) {
    return in_rtn(t, attitude.state_at(t).q_body_eci.conjugate() * Vector3::UnitZ());
  };
  ASSERT_TRUE(attitude.take({100.0, {0.0, 1.0, 0.0}, {0.0, 0.0, 0.0}}));
  ASSERT_TRUE(attitude.take({300.0, {0.0, 0.0, 1.0}, {0.0, 0.0, 0.0}}));
  ASSERT_TRUE(attitude.take({200.0, {0.0, 0.0, -1.0}, {0.0, 0.0, 0.0}}));
  EXPECT_NEAR(boresight(150.0).y(), 1.0, 1e-14);
  EXPECT_NEAR(boresight(250.0).z(), -1.0, 1e-14);
  EXPECT_NEAR(boresight(350.0).z(), -1.0, 1e-14);
}

TEST(CommandedAttitude, RefusesWhatLeavesTheTurnOpen) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  const Vector3 still = Vector3::Zero(), behind(0.0, -1.0, 0.0);
  EXPECT_TRUE(leaves_zenith_clear(behind, still));
  EXPECT_TRUE(leaves_zenith_clear({1.0, 0.02, 0.0}, still));
  EXPECT_FALSE(leaves_zenith_clear({-1.0, 0.005, 0.0}, still)) << "nadir";
  EXPECT_FALSE(leaves_zenith_clear(Vector3::Zero(), still));
  EXPECT_FALSE(leaves_zenith_clear({0.0, -1.0, kNaN}, still));
  EXPECT_FALSE(leaves_zenith_clear(behind, {0.0, kNaN, 0.0}));
  EXPECT_FALSE(leaves_zenith_clear({1.0, -0.1, 0.0}, {0.0, 1e-3, 0.0})) << "passes the zenith after 100 s";
  EXPECT_TRUE(leaves_zenith_clear({1.0, -0.1, 0.0}, {0.0, 1e-4, 0.0})) << "would after 1000 s, when the line has ended";
  EXPECT_FALSE(leaves_zenith_clear({0.2, -0.1, 0.0}, {2e-3, 1e-3 / 6.0, 0.0})) << "ends there";

  CommandedAttitude attitude({}, {}, own_at);
  ASSERT_TRUE(attitude.take({100.0, behind, still}));
  const Quaterniond before = attitude.state_at(200.0).q_body_eci;
  EXPECT_FALSE(attitude.take({100.0, {1.0, 0.0, 0.0}, still}));
  EXPECT_FALSE(attitude.take({kNaN, behind, still}));
  EXPECT_EQ(attitude.state_at(200.0).q_body_eci.coeffs(), before.coeffs());

  EXPECT_THROW(CommandedAttitude({.second_body = Vector3::UnitZ()}, {}, own_at), std::invalid_argument);
  EXPECT_THROW(CommandedAttitude({.initial_boresight_rtn = Vector3::UnitX()}, {}, own_at), std::invalid_argument);
  EXPECT_THROW(CommandedAttitude({}, {}, {}), std::invalid_argument);
}

fsw::GpsTime after(double seconds) {
  return mission_epoch() + fsw::nearest_duration(seconds);
}

TruthModel model_with(bool commanded) {
  TruthSettings settings = mission_settings();
  settings.gravity_degree = settings.gravity_order = 10;
  TruthModel model(settings);
  model.add_spacecraft("servicer", servicer_state());
  if (commanded) model.set_attitude(0, CommandedSettings{{}, some_error()});
  return model;
}

TEST(CommandedAttitude, InTheTruthModelChangesNoOrbit) {
  TruthModel with = model_with(true), without = model_with(false);
  for (double t = 60.0; t <= 3000.0; t += 60.0) {
    with.advance_to(after(t));
    without.advance_to(after(t));
    ASSERT_TRUE(with.command_pointing(0, after(t + 1.0), Vector3(std::sin(t), -1.0, 0.0).normalized(), {0, 0, 1e-4}));
  }
  EXPECT_TRUE(same_bits(with.state(0), without.state(0)));
}

TEST(CommandedAttitude, ACommandOfThePastCountsFromNowWhereItsLineHasLed) {
  TruthModel model = model_with(true);
  const Vector3 boresight(0.0, -1.0, 0.0), rate(3e-4, 0.0, 1e-4);
  model.advance_to(after(100.0));
  const Quaterniond told = model.attitude_at(0, after(90.0)).q_body_eci;
  ASSERT_TRUE(model.command_pointing(0, after(40.0), boresight, rate));
  EXPECT_EQ(model.attitude_at(0, after(90.0)).q_body_eci.coeffs(), told.coeffs());
  model.advance_to(after(130.0));
  const Vector3 wanted = (boresight + 90.0 * rate).normalized();
  const Vector3 seen =
      fsw::orbit::R_rtn_eci(model.state(0)) * (model.attitude(0).q_body_eci.conjugate() * Vector3::UnitZ());
  // Control errors of this test: 490 and 300 arcsec about the axes across the boresight, added up.
  EXPECT_LT((seen - wanted).norm(), 600.0 * kArcsecond);
  EXPECT_GT((seen - boresight).norm(), 0.02);
}

TEST(CommandedAttitude, OtherAttitudesTakeNoCommands) {
  TruthModel model = model_with(false);
  EXPECT_THROW(static_cast<void>(model.command_pointing(0, after(0.0), {0, 1, 0}, {0, 0, 0})), std::logic_error);
  model.set_attitude(0, PointedSettings{});
  EXPECT_THROW(static_cast<void>(model.command_pointing(0, after(0.0), {0, 1, 0}, {0, 0, 0})), std::logic_error);
  EXPECT_THROW(static_cast<void>(model.command_pointing(7, after(0.0), {0, 1, 0}, {0, 0, 0})), std::out_of_range);
}

}  // namespace

}  // namespace vbar::truth::test
