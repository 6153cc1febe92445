// A thruster whose burns have a duration: the rocket equation, its limits, and what it reports.

#include "host_sim/twins/finite_thruster.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace vbar::twins {
namespace {

using fsw::Vector3;

const fsw::GpsTime kBurn = fsw::GpsTime{} + fsw::duration_of_seconds(1'000'000'000);

FiniteThruster::Settings settings() {
  FiniteThruster::Settings of;
  of.spacecraft_number = 1;
  of.thruster = {.thrust_n = 0.02,
                 .specific_impulse_s = 65.0,
                 .propellant_kg = 1.0,
                 .minimum_impulse_ns = 1e-3,
                 .maximum_on_time_s = 400.0,
                 .rise_s = 0.1,
                 .fall_s = 0.3};
  of.mass_kg = of.nominal_mass_kg = 30.0;
  return of;
}

FiniteThruster thruster(const FiniteThruster::Settings& of = settings()) {
  return {of, engine::RandomStream(1, "servicer/thruster")};
}

vbar::maneuver_command command(std::int32_t id, const Vector3& dv_rtn) {
  vbar::maneuver_command message{};
  message.maneuver_id = id;
  for (int k = 0; k < 3; ++k) message.dv_rtn[k] = dv_rtn(k);
  return message;
}

Execution flown(FiniteThruster& thruster, std::int32_t id, const Vector3& dv_rtn, fsw::GpsTime time = kBurn) {
  const auto wanted = command(id, dv_rtn);
  return thruster.execute(wanted, time, time - thruster.lead(wanted));
}

std::string reason_of(const Execution& execution) {
  EXPECT_EQ(execution.maneuver.accepted, 0);
  EXPECT_FALSE(execution.arc);
  EXPECT_FALSE(execution.packet.empty());
  return execution.notes.empty() ? "" : execution.notes.back().text;
}

TEST(FiniteThruster, UsesThePropellantOfTheRocketEquation) {
  FiniteThruster one = thruster();
  double dv = 0.0;
  for (int k = 0; k < 50; ++k) {
    const Vector3 wanted(0.01 + 0.002 * k, -0.03, 0.02);
    const Execution execution = flown(one, k, wanted, kBurn + fsw::duration_of_seconds(1000 * k));
    ASSERT_EQ(execution.maneuver.accepted, 1) << k;
    const Vector3 executed(execution.maneuver.dv_rtn[0], execution.maneuver.dv_rtn[1], execution.maneuver.dv_rtn[2]);
    EXPECT_LT((executed - wanted).norm(), 1e-12);
    dv += executed.norm();
  }
  EXPECT_NEAR(one.propellant_used_kg(), 30.0 * -std::expm1(-dv / (65.0 * 9.80665)), 1e-9 * one.propellant_used_kg());
}

TEST(FiniteThruster, CentresABurnOnItsTime) {
  FiniteThruster one = thruster();
  const Vector3 dv(0.0, 0.1, 0.0);
  const Execution execution = flown(one, 1, dv);
  ASSERT_TRUE(execution.arc);
  const double duration_s = execution.arc->end_s() - execution.arc->begin_s;
  EXPECT_NEAR(fsw::seconds(one.lead(command(2, dv))), 0.5 * duration_s, 0.3);  // lighter by the first burn
  // 30 kg, 0.1 m/s, 0.02 N: 150 s, less what the loss of mass saves; the valve closes 0.1 s earlier, as the fall is
  // longer than the rise.
  EXPECT_NEAR(execution.arc->rise_s + execution.arc->hold_s, 150.0 * (1.0 - 0.5 * 0.1 / (65.0 * 9.80665)) - 0.1, 1e-3);
  EXPECT_EQ(execution.time, kBurn);
}

TEST(FiniteThruster, GivesPulsesTooShortForFullThrust) {
  FiniteThruster one = thruster();
  const Execution execution = flown(one, 1, Vector3(0.0, 5e-5, 0.0));  // 1.5 mN s; its edges alone take 4 mN s
  ASSERT_TRUE(execution.arc);
  EXPECT_EQ(execution.arc->hold_s, 0.0);
  EXPECT_LT(execution.arc->peak_n, 0.02);
  EXPECT_NEAR(execution.arc->impulse_ns(execution.arc->end_s()), 1.5e-3, 1e-8);
}

TEST(FiniteThruster, RejectsWhatItCannotExecute) {
  FiniteThruster one = thruster();
  EXPECT_EQ(reason_of(flown(one, 1, Vector3(0.0, 3e-5, 0.0))), "below the smallest impulse");
  EXPECT_EQ(reason_of(flown(one, 2, Vector3(0.0, 0.3, 0.0))), "beyond the longest on-time");
  EXPECT_EQ(reason_of(one.execute(command(3, {0.0, 0.1, 0.0}), kBurn, kBurn)), "too late to begin");
  ASSERT_EQ(flown(one, 4, Vector3(0.0, 0.1, 0.0)).maneuver.accepted, 1);
  EXPECT_EQ(reason_of(flown(one, 5, Vector3(0.0, 0.1, 0.0), kBurn + fsw::duration_of_seconds(70))),
            "before the last burn has ended");
  FiniteThruster::Settings nearly_empty = settings();
  nearly_empty.thruster.propellant_kg = 1e-3;
  FiniteThruster other = thruster(nearly_empty);
  EXPECT_EQ(reason_of(flown(other, 1, Vector3(0.0, 0.1, 0.0))), "without propellant for it");
  EXPECT_EQ(other.propellant_used_kg(), 0.0);
}

TEST(FiniteThruster, ExecutesMoreOnALighterSpacecraft) {
  FiniteThruster::Settings light = settings();
  light.mass_kg = 27.0;
  FiniteThruster one = thruster(light);
  EXPECT_NEAR(flown(one, 1, Vector3(0.0, 0.1, 0.0)).maneuver.dv_rtn[1], 0.1 * 30.0 / 27.0, 1e-5);
}

TEST(FiniteThruster, ErrsInFlowAndDirection) {
  FiniteThruster::Settings noisy = settings();
  noisy.errors = {.magnitude = 0.02, .pointing_rad = 0.01};
  FiniteThruster one = thruster(noisy), exact = thruster();
  const Vector3 dv(0.0, 0.1, 0.0);
  const Execution with = flown(one, 1, dv), without = flown(exact, 1, dv);
  EXPECT_NE(with.arc->peak_n, without.arc->peak_n);
  EXPECT_EQ(with.arc->hold_s, without.arc->hold_s);
  EXPECT_LT(with.arc->direction_rtn.dot(Vector3::UnitY()), 1.0);
}

}  // namespace
}  // namespace vbar::twins
