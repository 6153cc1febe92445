// Motions that follow one another: attitude and rate are continuous, the rate is that of the attitude, and the slew
// ends on the profile.

#include "host_sim/truth/attitude/attitude_sequence.h"

#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "host_sim/truth/attitude/pointing_profile.h"
#include "host_sim/truth/attitude/rigid_body.h"
#include "tests/support/accuracy.h"
#include "tests/unit/host_sim/truth/attitude/circular_orbit.h"

namespace vbar::truth::test {
namespace {

using Eigen::Quaterniond;
using fsw::Vector3;

constexpr double kBegin_s = 1000.0, kSlew_s = 600.0, kEnd_s = kBegin_s + kSlew_s;
constexpr double kFastTumble = 1.5 * kTwoPi / 360.0;  // rad/s, the fastest of the experiments

OrbitalMotion motion_at(double t) {
  const CircularOrbit orbit;
  const double n = orbit.mean_motion();
  return {orbit.position(t), orbit.velocity(t), -n * n * orbit.position(t)};
}

std::unique_ptr<AttitudeMotion> pointing(Direction boresight) {
  PointingSettings settings;
  settings.boresight_to = boresight;
  return std::make_unique<PointingProfile>(settings, motion_at, MotionOfTime(), SunOfTime());
}

std::unique_ptr<AttitudeMotion> tumble(double rate = kFastTumble) {
  const fsw::Matrix3 inertia = Vector3(2.0, 3.0, 4.0).asDiagonal();
  const AttitudeState start{Quaterniond(0.5, 0.5, -0.5, 0.5), rate * Vector3(2.0, -1.0, 2.0) / 3.0};
  return std::make_unique<RigidBody>(inertia, std::vector<std::unique_ptr<Torque>>(), RigidBody::OrbitOfTime(), 1e-12,
                                     0.0, start);
}

AttitudeSequence tumble_to_zenith() {
  std::vector<AttitudeSequence::Later> later;
  later.push_back({kBegin_s, kSlew_s, pointing(Direction::kZenith)});
  return {tumble(), std::move(later)};
}

/// The rotation vector from -h to +h over 2 h, extrapolated (Richardson): its error is that of h^4.
Vector3 differenced_rate(const AttitudeSequence& sequence, double t) {
  const auto over = [&](double h) -> Vector3 {
    const Eigen::AngleAxisd rotation(sequence.state_at(t + h).q_body_eci *
                                     sequence.state_at(t - h).q_body_eci.conjugate());
    return -rotation.angle() / (2.0 * h) * rotation.axis();
  };
  return (4.0 * over(0.25) - over(0.5)) / 3.0;
}

TEST(AttitudeSequence, RateIsTheDerivativeOfTheAttitudeDuringTheSlew) {
  AttitudeSequence sequence = tumble_to_zenith();
  accuracy::Largest error, greatest;
  for (double t = kBegin_s + 1.0; t < kEnd_s - 1.0; t += 7.3) {
    sequence.advance_to(t + 1.0, t + 2.0);
    const Vector3 rate = sequence.state_at(t).rate_body;
    error.add((rate - differenced_rate(sequence, t)).norm());
    greatest.add(rate.norm());
  }
  accuracy::expect_below("attitude: rate during a slew", "differenced attitude, 82 instants", error, 1e-9, "rad/s");
  // The cubic polynomial begins at the rate of the tumble times the inverse Jacobian of an angle up to pi (at most
  // pi / 2), and does not exceed it by more than 1.5 pi / T of the angle and (1 + pi / 2) times the rate of the orbit.
  EXPECT_LT(greatest, 0.5 * kTwoPi / 2.0 * kFastTumble + 0.75 * kTwoPi / kSlew_s + 2.8e-3);
}

TEST(AttitudeSequence, AttitudeAndRateAreContinuous) {
  AttitudeSequence sequence = tumble_to_zenith();
  const std::unique_ptr<AttitudeMotion> free = tumble(), zenith = pointing(Direction::kZenith);
  constexpr double kStep_s = 1e-6;
  sequence.advance_to(kEnd_s + 1.0, kEnd_s + 1.0);
  free->advance_to(kBegin_s, kBegin_s);
  const AttitudeState before = free->state_at(kBegin_s), at_begin = sequence.state_at(kBegin_s);
  EXPECT_LT(angle_between(before.q_body_eci, at_begin.q_body_eci), 1e-12);
  EXPECT_LT((before.rate_body - at_begin.rate_body).norm(), 1e-12);
  const AttitudeState late = sequence.state_at(kEnd_s - kStep_s), after = zenith->state_at(kEnd_s);
  // A microsecond at the rate of the orbit, 1e-9 rad; the angular acceleration at the end is below 1e-3 rad/s^2.
  EXPECT_LT(angle_between(late.q_body_eci, after.q_body_eci), 2e-9);
  EXPECT_LT((late.rate_body - after.rate_body).norm(), 2e-9);
  const AttitudeState follows = sequence.state_at(kEnd_s + 1.0), profile = zenith->state_at(kEnd_s + 1.0);
  EXPECT_EQ(follows.q_body_eci.coeffs(), profile.q_body_eci.coeffs());
  EXPECT_EQ(follows.rate_body, profile.rate_body);
}

// From rest to rest between two attitudes at an angle, the polynomial is 1 - 3 s^2 + 2 s^3 of that angle about a fixed
// axis: a quarter of the time leaves 27/32 of it, half of it one half.
TEST(AttitudeSequence, FromRestToRestIsTheCubicAboutAFixedAxis) {
  const Vector3 axis = Vector3(1.0, -2.0, 2.0) / 3.0;
  constexpr double kAngle = 2.0;
  const SlewStart start{{Quaterniond(Eigen::AngleAxisd(-kAngle, axis)), Vector3::Zero()}, {}};
  for (const auto& [share, left] : {std::pair(0.25, 27.0 / 32.0), std::pair(0.5, 0.5), std::pair(1.0, 0.0)}) {
    const AttitudeState state = slewed_attitude(start, {}, share * kSlew_s, kSlew_s);
    EXPECT_LT(angle_between(state.q_body_eci, Quaterniond(Eigen::AngleAxisd(-left * kAngle, axis))), 1e-12) << share;
    const Vector3 rate = -6.0 * share * (1.0 - share) / kSlew_s * kAngle * axis;
    EXPECT_LT((state.rate_body - rate).norm(), 1e-15) << share;
  }
}

TEST(AttitudeSequence, TheInstantsAskedForDoNotMatter) {
  AttitudeSequence fine = tumble_to_zenith(), coarse = tumble_to_zenith();
  for (double t = 0.0; t <= kBegin_s + 300.0; t += 10.0) fine.advance_to(t, t);
  coarse.advance_to(kBegin_s + 300.0, kBegin_s + 300.0);
  EXPECT_EQ(fine.state_at(kBegin_s + 200.0).q_body_eci.coeffs(), coarse.state_at(kBegin_s + 200.0).q_body_eci.coeffs());
}

TEST(AttitudeSequence, AThirdMotionFollowsTheSecond) {
  std::vector<AttitudeSequence::Later> later;
  later.push_back({kBegin_s, kSlew_s, pointing(Direction::kZenith)});
  later.push_back({3000.0, 100.0, pointing(Direction::kNadir)});
  AttitudeSequence sequence(tumble(), std::move(later));
  sequence.advance_to(4000.0, 4000.0);
  EXPECT_LT(
      angle_between(sequence.state_at(3000.0).q_body_eci, pointing(Direction::kZenith)->state_at(3000.0).q_body_eci),
      1e-12);
  EXPECT_LT(
      angle_between(sequence.state_at(3100.0).q_body_eci, pointing(Direction::kNadir)->state_at(3100.0).q_body_eci),
      1e-12);
}

TEST(AttitudeSequence, RefusesSlewsThatOverlapOrTakeNoTime) {
  const auto make = [](double first_slew_s, double second_from_s) {
    std::vector<AttitudeSequence::Later> later;
    later.push_back({kBegin_s, first_slew_s, pointing(Direction::kZenith)});
    later.push_back({second_from_s, 100.0, pointing(Direction::kNadir)});
    return AttitudeSequence(tumble(), std::move(later));
  };
  EXPECT_NO_THROW(make(kSlew_s, kEnd_s));
  EXPECT_THROW(make(kSlew_s, kEnd_s - 1.0), std::invalid_argument);
  EXPECT_THROW(make(0.0, kEnd_s), std::invalid_argument);
  EXPECT_THROW(AttitudeSequence(tumble(), {}), std::invalid_argument);
}

}  // namespace
}  // namespace vbar::truth::test
