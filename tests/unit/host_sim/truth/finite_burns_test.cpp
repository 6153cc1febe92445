// Burns with a duration: against an integration of position, velocity and mass in extended precision that shares
// nothing with the truth model, against the rocket equation, and in the limit of impulses.

#include <array>
#include <cmath>

#include <boost/numeric/odeint.hpp>
#include <gtest/gtest.h>

#include "host_sim/truth/forces/thrust_force.h"
#include "host_sim/truth/spacecraft_propagator.h"
#include "tests/support/accuracy.h"
#include "tests/unit/host_sim/truth/truth_fixtures.h"

namespace vbar::truth {
namespace {

using fsw::Vector3;
using fsw::orbit::CartesianState;

using Extended = long double;
using State = std::array<Extended, 7>;  // position, velocity, mass

constexpr Extended kJ2 = 1.0826358191967e-3L;

Extended norm(Extended x, Extended y, Extended z) {
  return std::sqrt(x * x + y * y + z * z);
}

/// Newton's equations under J2 with a thrust that is linear in time in one phase of a burn.
struct Phase {
  Extended begin, end, force_at_begin, force_at_end, exhaust;
  Vector3 direction_rtn;

  void operator()(const State& y, State& rate, Extended t) const {
    const Extended r = norm(y[0], y[1], y[2]);
    const Extended z2 = 5.0L * y[2] * y[2] / (r * r);
    const Extended gm = test::kGm, radius = test::kEarthRadius;
    const Extended central = -gm / (r * r * r);
    const Extended oblate = -1.5L * kJ2 * gm * radius * radius / (r * r * r * r * r);
    const Extended force = force_at_begin + (force_at_end - force_at_begin) * (t - begin) / (end - begin);
    std::array<Extended, 3> radial{}, normal{}, along{};
    for (std::size_t i = 0; i < 3; ++i) radial[i] = y[i] / r;
    normal = {y[1] * y[5] - y[2] * y[4], y[2] * y[3] - y[0] * y[5], y[0] * y[4] - y[1] * y[3]};
    const Extended h = norm(normal[0], normal[1], normal[2]);
    for (Extended& n : normal) n /= h;
    along = {normal[1] * radial[2] - normal[2] * radial[1], normal[2] * radial[0] - normal[0] * radial[2],
             normal[0] * radial[1] - normal[1] * radial[0]};
    for (std::size_t i = 0; i < 3; ++i) {
      const Extended share =
          direction_rtn.x() * radial[i] + direction_rtn.y() * along[i] + direction_rtn.z() * normal[i];
      rate[i] = y[i + 3];
      rate[i + 3] = central * y[i] + oblate * y[i] * ((i == 2 ? 3.0L : 1.0L) - z2) + force / y[6] * share;
    }
    rate[6] = -force / exhaust;
  }
};

State flown(State y, const Phase& phase) {
  using Stepper = boost::numeric::odeint::runge_kutta_fehlberg78<State, Extended>;
  static const Stepper stepper;
  if (phase.end > phase.begin) {
    boost::numeric::odeint::integrate_adaptive(
        boost::numeric::odeint::make_controlled(Extended{1e-9L}, Extended{1e-16L}, stepper), phase, y, phase.begin,
        phase.end, std::min(Extended{10.0L}, phase.end - phase.begin));
  }
  return y;
}

ThrustArc arc_at(double begin_s) {
  return {.begin_s = begin_s,
          .rise_s = 0.4,
          .hold_s = 211.3,
          .fall_s = 0.7,
          .peak_n = 0.02,
          .direction_rtn = Vector3(0.3, -0.9, 0.4).normalized(),
          .mass_kg = 30.0,
          .exhaust_velocity_mps = 600.0};
}

SpacecraftPropagator propagator_with_thrust() {
  return SpacecraftPropagator(
      test::dynamics_with(test::list(std::make_unique<test::InertialJ2>(), std::make_unique<ThrustForce>())), 1e-13,
      0.0, test::servicer_state());
}

TEST(FiniteBurns, FollowAnIndependentIntegrationForADay) {
  constexpr double kDay = 86400.0;
  SpacecraftPropagator propagator = propagator_with_thrust();
  const CartesianState start = test::servicer_state();
  State y{start.position_eci.x(),
          start.position_eci.y(),
          start.position_eci.z(),
          start.velocity_eci.x(),
          start.velocity_eci.y(),
          start.velocity_eci.z(),
          30.0L};
  Extended now = 0.0L;
  for (const double begin_s : {1234.5, 40000.25}) {
    ThrustArc arc = arc_at(begin_s);
    y = flown(y, {now, begin_s, 0.0L, 0.0L, 1.0L, Vector3::UnitX()});
    arc.mass_kg = static_cast<double>(y[6]);
    propagator.advance_to(begin_s);
    propagator.begin_burn(arc);
    const Extended full = begin_s + Extended{arc.rise_s}, closing = full + Extended{arc.hold_s};
    const Extended end = closing + Extended{arc.fall_s}, peak = arc.peak_n, exhaust = arc.exhaust_velocity_mps;
    y = flown(y, {begin_s, full, 0.0L, peak, exhaust, arc.direction_rtn});
    y = flown(y, {full, closing, peak, peak, exhaust, arc.direction_rtn});
    y = flown(y, {closing, end, peak, 0.0L, exhaust, arc.direction_rtn});
    now = end;
    EXPECT_NEAR(arc.mass_at_kg(arc.end_s()), static_cast<double>(y[6]), 1e-12);
  }
  y = flown(y, {now, kDay, 0.0L, 0.0L, 1.0L, Vector3::UnitX()});
  propagator.advance_to(kDay);
  const Vector3 expected(static_cast<double>(y[0]), static_cast<double>(y[1]), static_cast<double>(y[2]));
  accuracy::expect_below("two burns of 212 s, position after a day",
                         "Newton's equations with mass, Fehlberg 7(8) in 80 bits",
                         (propagator.state().position_eci - expected).norm(), 1e-3, "m");
}

TEST(FiniteBurns, ApproachAnImpulseAsThrustGrows) {
  // A burn centred on the time of the impulse: what is left is of second order in its duration, and of first order,
  // small, by the loss of mass.
  constexpr double kCentre = 2000.0, kEnd = 20000.0, kDv = 0.2, kMass = 30.0, kExhaust = 2000.0;
  SpacecraftPropagator impulsive = propagator_with_thrust();
  impulsive.advance_to(kCentre);
  impulsive.apply_impulse_rtn(kDv * Vector3::UnitY());
  impulsive.advance_to(kEnd);
  const double propellant_kg = kMass * -std::expm1(-kDv / kExhaust);
  double last = 0.0;
  for (const double thrust_n : {0.02, 0.2, 2.0}) {
    SpacecraftPropagator finite = propagator_with_thrust();
    const double duration_s = propellant_kg * kExhaust / thrust_n;
    finite.advance_to(kCentre - 0.5 * duration_s);
    finite.begin_burn({.begin_s = kCentre - 0.5 * duration_s,
                       .hold_s = duration_s,
                       .peak_n = thrust_n,
                       .mass_kg = kMass,
                       .exhaust_velocity_mps = kExhaust});
    finite.advance_to(kEnd);
    const double difference = (finite.state().position_eci - impulsive.state().position_eci).norm();
    RecordProperty("difference_m_at_" + std::to_string(thrust_n) + "_N", std::to_string(difference));
    if (last > 0.0) {
      EXPECT_LT(difference, 0.11 * last) << thrust_n;
    }
    last = difference;
  }
  EXPECT_LT(last, 0.01);
}

TEST(FiniteBurns, ChangeNothingBeforeAndAfter) {
  // A burn without force does not move a spacecraft beyond the tolerance of restarted steps.
  SpacecraftPropagator with = propagator_with_thrust(), without = propagator_with_thrust();
  with.advance_to(3000.0);
  with.begin_burn({.begin_s = 3000.0, .hold_s = 100.0, .peak_n = 0.0, .mass_kg = 30.0, .exhaust_velocity_mps = 1000.0});
  with.advance_to(20000.0);
  without.advance_to(20000.0);
  EXPECT_LT((with.state().position_eci - without.state().position_eci).norm(), 1e-4);
}

TEST(FiniteBurns, AreRefusedWhereTheyOverlapOrBurnsAreImpulses) {
  SpacecraftPropagator propagator = propagator_with_thrust();
  propagator.begin_burn(arc_at(0.0));
  propagator.advance_to(100.0);
  EXPECT_THROW(propagator.begin_burn(arc_at(100.0)), std::invalid_argument);
  EXPECT_THROW(propagator.begin_burn(arc_at(200.0)), std::invalid_argument);
  SpacecraftPropagator impulsive(test::dynamics_with(test::list(std::make_unique<test::InertialJ2>())), 1e-13, 0.0,
                                 test::servicer_state());
  EXPECT_THROW(impulsive.begin_burn(arc_at(0.0)), std::logic_error);
}

TEST(FiniteBurns, HaveThrustAndMassByTheirProfile) {
  const ThrustArc arc = arc_at(10.0);
  EXPECT_EQ(arc.force_n(9.9), 0.0);
  EXPECT_NEAR(arc.force_n(10.2), 0.01, 1e-12);
  EXPECT_EQ(arc.force_n(100.0), 0.02);
  EXPECT_NEAR(arc.force_n(arc.end_s() - 0.35), 0.01, 1e-12);
  EXPECT_EQ(arc.force_n(arc.end_s() + 0.1), 0.0);
  EXPECT_NEAR(arc.impulse_ns(arc.end_s()), 0.02 * (211.3 + 0.5 * 1.1), 1e-12);
  EXPECT_NEAR(arc.mass_at_kg(1e6), 30.0 - 0.02 * (211.3 + 0.5 * 1.1) / 600.0, 1e-12);
}

}  // namespace
}  // namespace vbar::truth
