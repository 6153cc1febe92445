// Attitudes in the truth model: carried with the real orbits, by the models that act on them.

#include <cmath>
#include <stdexcept>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "host_sim/truth/truth_model.h"
#include "tests/support/accuracy.h"
#include "tests/unit/host_sim/truth/truth_fixture.h"

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
}  // namespace vbar::truth::test
