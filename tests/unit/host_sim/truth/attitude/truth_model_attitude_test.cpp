// Attitudes in the truth model: carried with the real orbits, by the models that act on them.

#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "host_sim/truth/attitude/attitude_sequence.h"
#include "host_sim/truth/attitude/pointing_profile.h"
#include "host_sim/truth/attitude/rigid_body.h"
#include "host_sim/truth/truth_model.h"
#include "tests/support/accuracy.h"
#include "tests/unit/host_sim/truth/truth_fixtures.h"

namespace vbar::truth::test {

namespace {

using fsw::Vector3;

fsw::GpsTime after(double seconds) {
  return mission_epoch() + fsw::nearest_duration(seconds);
}

/// A box with Tango's moments, its centre of mass off its centre.
TumbleSettings tumbling_box(std::vector<TorqueKind> torques) {
  TumbleSettings settings;
  settings.body.inertia_kgm2 = Vector3(2.69, 3.46, 3.11).asDiagonal();
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-0.3, 0.3}) {
      settings.body.facets.push_back(
          {0.4, Vector3(0.02, -0.03, 0.05) + side * Vector3::Unit(axis), side / 0.3 * Vector3::Unit(axis), 0.3, 0.2});
    }
  }
  settings.torques = std::move(torques);
  settings.drag_coefficient = 2.25;
  settings.start = {Eigen::Quaterniond(0.3, -0.5, 0.2, 0.7).normalized(), {0.01, -0.008, 0.005}};
  return settings;
}

const std::vector<TorqueKind> kAllTorques{TorqueKind::kGravityGradient, TorqueKind::kAerodynamic,
                                          TorqueKind::kRadiation};

/// Servicer, pointing at the tumbling target 100 m ahead.
TruthModel pair(int threads = 1, const std::vector<TorqueKind>& torques = kAllTorques) {
  TruthSettings settings = mission_settings();
  settings.gravity_degree = settings.gravity_order = 10;
  settings.threads = threads;
  TruthModel model(settings);
  model.add_spacecraft("servicer", servicer_state());
  model.add_spacecraft("target", target_state(100.0));
  model.set_attitude(
      0,
      PointedSettings{{Direction::kSpacecraft, Vector3::UnitZ(), Direction::kOrbitNormal, Vector3::UnitY()}, "target"});
  model.set_attitude(1, tumbling_box(torques));
  return model;
}

bool same_attitude(const AttitudeState& a, const AttitudeState& b) {
  return a.q_body_eci.coeffs() == b.q_body_eci.coeffs() && a.rate_body == b.rate_body;
}

LaterAttitudeSettings zenith_from(double seconds) {
  LaterAttitudeSettings later;
  later.from_s = seconds;
  later.slew_s = 600.0;
  later.attitude = PointedSettings{};
  return later;
}

// A slew begins and ends where the two profiles are, also for a body under torques; after its end there is none.
TEST(TruthModelAttitude, ALaterProfileFollowsASlewUnlessItBeganBeforeTheStart) {
  TruthModel tumbling = pair(), slewing = pair(2), pointing = pair();
  slewing.set_attitude(1, tumbling_box(kAllTorques), {zenith_from(1800.0)});
  pointing.set_attitude(1, PointedSettings{});
  for (TruthModel* model : {&tumbling, &slewing, &pointing}) model->advance_to(after(1800.0));
  // Steps of the integrator end at the slew.
  EXPECT_LT(angle_between(tumbling.attitude(1).q_body_eci, slewing.attitude(1).q_body_eci), 1e-8);
  for (TruthModel* model : {&slewing, &pointing}) model->advance_to(after(2100.0));
  EXPECT_GT(angle_between(slewing.attitude(1).q_body_eci, pointing.attitude(1).q_body_eci), 0.1);
  for (TruthModel* model : {&slewing, &pointing}) model->advance_to(after(2400.0));
  EXPECT_TRUE(same_attitude(slewing.attitude(1), pointing.attitude(1)));

  TruthModel late = pair();
  late.advance_to(after(1800.0));
  late.set_attitude(1, tumbling_box(kAllTorques), {zenith_from(1800.0)});
  late.advance_to(after(2100.0));
  pointing = pair();
  pointing.set_attitude(1, PointedSettings{});
  pointing.advance_to(after(2100.0));
  EXPECT_LT(angle_between(late.attitude(1).q_body_eci, pointing.attitude(1).q_body_eci), 1e-9);

  LaterAttitudeSettings at_spacecraft = zenith_from(1800.0);
  at_spacecraft.attitude = PointedSettings{{.boresight_to = Direction::kSpacecraft}, "servicer"};
  EXPECT_THROW(late.set_attitude(1, PointedSettings{}, {at_spacecraft}), std::invalid_argument);
}

TEST(TruthModelAttitude, IsTheSameForAnyTimesAndThreads) {
  TruthModel at_once = pair(), often = pair(), threaded = pair(2);
  at_once.advance_to(after(7000.0));
  threaded.advance_to(after(7000.0));
  for (double t = 0.4; t < 7000.0; t += 31.7) {
    often.advance_to(after(t));
    static_cast<void>(often.attitude(0));
    static_cast<void>(often.attitude_at(1, after(t)));
  }
  often.advance_to(after(7000.0));
  for (const std::size_t i : {0u, 1u}) {
    EXPECT_TRUE(same_attitude(at_once.attitude(i), often.attitude(i))) << i;
    EXPECT_TRUE(same_attitude(at_once.attitude(i), threaded.attitude(i))) << i;
    EXPECT_TRUE(same_attitude(at_once.attitude_at(i, after(6900.0)), often.attitude_at(i, after(6900.0)))) << i;
  }
}

TEST(TruthModelAttitude, DoesNotChangeTheOrbit) {
  TruthSettings settings = mission_settings();
  settings.gravity_degree = settings.gravity_order = 10;
  TruthModel without(settings), with = pair();
  without.add_spacecraft("servicer", servicer_state());
  without.add_spacecraft("target", target_state(100.0));
  for (TruthModel* model : {&without, &with}) {
    model->advance_to(after(3000.0));
    model->apply_impulse_rtn(1, {0.0, 0.01, 0.02});
    model->advance_to(after(6000.0));
  }
  for (const std::size_t i : {0u, 1u}) EXPECT_TRUE(same_bits(with.state(i), without.state(i))) << i;
}

TEST(TruthModelAttitude, EveryTorqueActs) {
  TruthModel free = pair(1, {});
  free.advance_to(after(6000.0));
  for (const TorqueKind kind : kAllTorques) {
    TruthModel model = pair(1, {kind});
    model.advance_to(after(6000.0));
    const double turned = angle_between(model.attitude(1).q_body_eci, free.attitude(1).q_body_eci);
    // 1e-9 N m on 3 kg m^2 for 6000 s and more; 100 km higher or lower would change none of it by a factor of ten.
    EXPECT_GT(turned, 1e-4) << static_cast<int>(kind);
  }
}

TEST(TruthModelAttitude, RadiationTorqueEndsStepsAtTheShadowsEdges) {
  // The orbit's own forces are gravity only: the attitude finds the edges by itself. Against a solution with a
  // tolerance a hundred times finer. An edge missed by a second would be 5e-8 rad/s, 1e-4 rad in the rest of the orbit.
  const auto flown = [](double tolerance) {
    TruthSettings settings = mission_settings();
    settings.gravity_degree = settings.gravity_order = 10;
    settings.tolerance = tolerance;
    TruthModel model(settings);
    model.add_spacecraft("target", target_state(0.0));
    model.set_attitude(0, tumbling_box({TorqueKind::kRadiation}));
    model.advance_to(after(6000.0));
    return model.attitude(0);
  };
  const AttitudeState usual = flown(1e-12), fine = flown(1e-14);
  // Some 10^3 steps with local errors up to 1e-12 of a rate of 0.014 rad/s, over 6000 s: 8e-8 rad.
  accuracy::expect_below("attitude: tumble under radiation torque through the Earth's shadow, one orbit",
                         "tolerance 100 times finer", angle_between(usual.q_body_eci, fine.q_body_eci), 1e-7, "rad");
}

TEST(TruthModelAttitude, PointsAtTheOtherSpacecraftWithItsOwnRate) {
  TruthModel model = pair();
  model.advance_to(after(1000.0));
  accuracy::Largest boresight, rate;
  for (double t = 1000.0; t < 5000.0; t += 400.0) {
    model.advance_to(after(t + 10.0));  // so that the states about t are known
    const AttitudeState now = model.attitude_at(0, after(t));
    const Vector3 los = model.state_at(1, after(t)).position_eci - model.state_at(0, after(t)).position_eci;
    boresight.add((now.q_body_eci * los).normalized().cross(Vector3::UnitZ()).norm());
    const double h = 5.0;
    const Eigen::AngleAxisd turn(model.attitude_at(0, after(t + h)).q_body_eci *
                                 model.attitude_at(0, after(t - h)).q_body_eci.conjugate());
    rate.add((now.rate_body + turn.angle() / (2.0 * h) * turn.axis()).norm());
  }
  EXPECT_LT(boresight, 1e-12);
  // The orbit's interpolant carries 1e-6 m of a line of sight of 100 m over 10 s, 1e-9 rad/s; the third derivative of a
  // turn once an orbit leaves n^3 h^2 / 6 = 5e-9 rad/s.
  EXPECT_LT(rate, 1e-8);
}

TEST(TruthModelAttitude, AnImpulseTurnsTheProfileNotTheBody) {
  TruthModel model = pair();
  model.set_attitude(0, PointedSettings{});  // zenith, and the orbit normal
  model.advance_to(after(1000.0));
  const AttitudeState servicer = model.attitude(0), target = model.attitude(1);
  for (const std::size_t i : {0u, 1u}) model.apply_impulse_rtn(i, {0.0, 0.0, 0.1});
  EXPECT_LT(angle_between(model.attitude(1).q_body_eci, target.q_body_eci), 1e-12);
  EXPECT_LT((model.attitude(1).rate_body - target.rate_body).norm(), 1e-13);
  // The orbit normal turns about the zenith by dv / v, to the square of that and to the flight path angle's, 1e-6.
  const double turned = angle_between(model.attitude(0).q_body_eci, servicer.q_body_eci);
  EXPECT_NEAR(turned * model.state(0).velocity_eci.norm() / 0.1, 1.0, 1e-4);
  model.advance_to(after(2000.0));
  EXPECT_NO_THROW(static_cast<void>(model.attitude(1)));
}

TEST(TruthModelAttitude, RefusesWhatCannotBe) {
  TruthModel model(mission_settings());
  model.add_spacecraft("servicer", servicer_state());
  EXPECT_FALSE(model.has_attitude(0));
  EXPECT_THROW(static_cast<void>(model.attitude(0)), std::logic_error);
  const auto at = [](const std::string& name) { return PointedSettings{{Direction::kSpacecraft}, name}; };
  EXPECT_THROW(model.set_attitude(0, at("servicer")), std::invalid_argument);
  EXPECT_THROW(model.set_attitude(0, at("nobody")), std::invalid_argument);
  EXPECT_THROW(model.set_attitude(0, at("")), std::invalid_argument);
  TumbleSettings shapeless = tumbling_box(kAllTorques);
  shapeless.body.facets.clear();
  EXPECT_THROW(model.set_attitude(0, shapeless), std::invalid_argument);
  EXPECT_THROW(model.set_attitude(7, tumbling_box({})), std::out_of_range);
  EXPECT_FALSE(model.has_attitude(0));
}

}  // namespace

// Motions that follow one another: attitude and rate are continuous, the rate is that of the attitude, and the slew
// ends on the profile.

namespace {

using Eigen::Quaterniond;

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
