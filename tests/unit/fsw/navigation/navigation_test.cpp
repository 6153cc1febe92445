// Measurements and own maneuvers are folded in at their own times; without measurements the state coasts and says so.

#include "fsw/navigation/navigation.h"

#include "fsw/filter/propagation.h"
#include "fsw/gnc/telecommand_checks.h"
#include "fsw/navigation/filter_configuration.h"
#include "fsw/orbit/propagate.h"
#include "fsw/orbit/rtn.h"
#include "tests/unit/fsw/messaging/configurations.h"

namespace vbar::fsw::navigation {
namespace {

using gnc::test::kServicer;
using gnc::test::packet_of;

constexpr std::int64_t kSecond = kNanosecondsPerSecond;

orbit::CartesianState servicer_state() {
  orbit::CartesianState state;  // the mission's servicer at the epoch, rounded
  state.position_eci = {12161.8, -7076153.6, -84606.6};
  state.velocity_eci = {-1068.57, -90.58, 7433.74};
  return state;
}

ideal_navigation measurement_of(const orbit::CartesianState& servicer, double separation_m = 100.0) {
  ideal_navigation message{};
  for (int k = 0; k < 3; ++k) {
    message.servicer_position_eci[k] = servicer.position_eci(k);
    message.servicer_velocity_eci[k] = servicer.velocity_eci(k);
    message.target_position_eci[k] = servicer.position_eci(k) + (k == 2 ? separation_m : 0.0);
    message.target_velocity_eci[k] = servicer.velocity_eci(k);
  }
  return message;
}

class NavigationTest : public ::testing::Test {
 protected:
  void update(std::int64_t seconds) {
    telecommands_.update({seconds * kSecond}, inbox_, gnc::telecommand_rules());
    navigation_.update({seconds * kSecond}, telecommands_, inbox_, measurements_);
    inbox_.clear(GpsTime{});
  }
  messaging::Inbox inbox_{kServicer};
  messaging::Telecommands telecommands_;
  MeasurementScheduler measurements_;
  NavigationSolution navigation_;
};

TEST_F(NavigationTest, StartsWithoutAStateAndTakesTheFirstMeasurement) {
  update(0);
  EXPECT_FALSE(navigation_.state().valid);
  EXPECT_EQ(inbox_.receive(packet_of({60 * kSecond}, measurement_of(servicer_state()))), Status::kOk);
  update(60);
  EXPECT_TRUE(navigation_.state().valid);
  EXPECT_EQ(navigation_.state().source, NavigationSource::kIdeal);
  EXPECT_EQ(navigation_.state().servicer.position_eci, servicer_state().position_eci);
}

TEST_F(NavigationTest, CoastsAsTheOrbitModelDoesAndGrowsUncertain) {
  EXPECT_EQ(inbox_.receive(packet_of({0}, measurement_of(servicer_state()))), Status::kOk);
  update(120);
  const auto expected = orbit::propagate_j2(servicer_state(), 120.0);
  ASSERT_TRUE(expected.ok());
  EXPECT_EQ(navigation_.state().servicer.position_eci, expected.value().position_eci);
  EXPECT_EQ(navigation_.state().source, NavigationSource::kPropagated);
  const double after_two_minutes = navigation_.state().sigma_rtn(0);
  EXPECT_GT(after_two_minutes, 0.0);
  update(600);
  EXPECT_GT(navigation_.state().sigma_rtn(0), after_two_minutes);
}

TEST_F(NavigationTest, AppliesItsOwnManeuverAtTheManeuversTime) {
  EXPECT_EQ(inbox_.receive(packet_of({0}, measurement_of(servicer_state()))), Status::kOk);
  executed_maneuver maneuver{};
  maneuver.accepted = 1;
  maneuver.dv_rtn[1] = 0.5;
  EXPECT_EQ(inbox_.receive(packet_of({30 * kSecond}, maneuver)), Status::kOk);
  update(60);
  const auto before = orbit::propagate_j2(servicer_state(), 30.0);
  const auto after = orbit::propagate_j2(orbit::apply_impulse_rtn(before.value(), {0.0, 0.5, 0.0}), 30.0);
  EXPECT_EQ(navigation_.state().servicer.position_eci, after.value().position_eci);
}

TEST_F(NavigationTest, ARefusedManeuverMovesNothing) {
  EXPECT_EQ(inbox_.receive(packet_of({0}, measurement_of(servicer_state()))), Status::kOk);
  executed_maneuver maneuver{};
  maneuver.dv_rtn[1] = 0.5;
  EXPECT_EQ(inbox_.receive(packet_of({30 * kSecond}, maneuver)), Status::kOk);
  update(60);
  const auto expected = orbit::propagate_j2(servicer_state(), 60.0);
  EXPECT_EQ(navigation_.state().servicer.position_eci, expected.value().position_eci);
}

TEST_F(NavigationTest, MeasurementsOfTheFutureAndOfThePastAreLeftOutAndCounted) {
  EXPECT_EQ(inbox_.receive(packet_of({60 * kSecond}, measurement_of(servicer_state()))), Status::kOk);
  update(60);
  EXPECT_EQ(inbox_.receive(packet_of({30 * kSecond}, measurement_of(servicer_state()))), Status::kOk);
  EXPECT_EQ(inbox_.receive(packet_of({900 * kSecond}, measurement_of(servicer_state()))), Status::kOk);
  update(120);
  EXPECT_EQ(inbox_.counters().rejected_time, 2);
  EXPECT_EQ(navigation_.state().last_measurement.ns, 60 * kSecond);
}

TEST_F(NavigationTest, AMeasurementThatIsNoOrbitMakesNoState) {
  ideal_navigation message = measurement_of(servicer_state());
  message.servicer_velocity_eci[2] = 20000.0;  // beyond escape
  EXPECT_EQ(inbox_.receive(packet_of({0}, message)), Status::kOk);
  update(0);
  EXPECT_FALSE(navigation_.state().valid);
}

// A measurement that took its time still counts, at its own time: what came since is flown again on top of it.
TEST_F(NavigationTest, ALateMeasurementIsFoldedInAtItsTime) {
  EXPECT_EQ(inbox_.receive(packet_of({0}, measurement_of(servicer_state()))), Status::kOk);
  executed_maneuver maneuver{};
  maneuver.accepted = 1;
  maneuver.dv_rtn[1] = 0.5;
  EXPECT_EQ(inbox_.receive(packet_of({50 * kSecond}, maneuver)), Status::kOk);
  update(60);

  orbit::CartesianState better = orbit::propagate_j2(servicer_state(), 40.0).value();
  better.position_eci.x() += 3.0;
  EXPECT_EQ(inbox_.receive(packet_of({40 * kSecond}, measurement_of(better))), Status::kOk);
  update(120);
  const auto at_burn = orbit::propagate_j2(better, 10.0);
  const auto expected = orbit::propagate_j2(orbit::apply_impulse_rtn(at_burn.value(), {0.0, 0.5, 0.0}), 70.0);
  EXPECT_EQ(navigation_.state().servicer.position_eci, expected.value().position_eci);
  EXPECT_EQ(navigation_.state().last_measurement.ns, 40 * kSecond);
  EXPECT_EQ(inbox_.counters().rejected_time, 0);
}

TEST_F(NavigationTest, BelievesACommandUntilTheActuatorSaysOtherwise) {
  EXPECT_EQ(inbox_.receive(packet_of({0}, measurement_of(servicer_state()))), Status::kOk);
  update(0);
  navigation_.expect_maneuver(5, {30 * kSecond}, {0.0, 0.5, 0.0});
  const auto at_burn = orbit::propagate_j2(servicer_state(), 30.0).value();
  const auto after = [&](double dv_t, double dt) {
    return orbit::propagate_j2(orbit::apply_impulse_rtn(at_burn, {0.0, dv_t, 0.0}), dt).value().position_eci;
  };
  update(20);  // not yet
  EXPECT_EQ(navigation_.state().servicer.position_eci,
            orbit::propagate_j2(servicer_state(), 20.0).value().position_eci);
  update(60);
  EXPECT_EQ(navigation_.state().servicer.position_eci, after(0.5, 30.0));

  executed_maneuver report{};  // two steps late, and it was 1 % less
  report.maneuver_id = 5;
  report.accepted = 1;
  report.dv_rtn[1] = 0.495;
  EXPECT_EQ(inbox_.receive(packet_of({30 * kSecond}, report)), Status::kOk);
  update(180);
  EXPECT_EQ(navigation_.state().servicer.position_eci, after(0.495, 150.0));

  report.accepted = 0;
  EXPECT_EQ(inbox_.receive(packet_of({30 * kSecond}, report, 1)), Status::kOk);
  update(240);
  EXPECT_EQ(navigation_.state().servicer.position_eci,
            orbit::propagate_j2(servicer_state(), 240.0).value().position_eci);
}

// A burn of a step's own instant comes after the step: a measurement of that instant does not know it, and neither does
// the state.
TEST_F(NavigationTest, ABurnAtTheStepsTimeIsOfTheNextStep) {
  navigation_.expect_maneuver(5, {60 * kSecond}, {0.0, 0.5, 0.0});
  EXPECT_EQ(inbox_.receive(packet_of({60 * kSecond}, measurement_of(servicer_state()))), Status::kOk);
  update(60);
  EXPECT_EQ(navigation_.state().servicer.velocity_eci, servicer_state().velocity_eci);
  update(120);
  const auto expected = orbit::propagate_j2(orbit::apply_impulse_rtn(servicer_state(), {0.0, 0.5, 0.0}), 60.0);
  EXPECT_EQ(navigation_.state().servicer.position_eci, expected.value().position_eci);
}

/// Navigation that knows the thruster: 0.2 m/s in 300 s.
class FiniteBurnNavigationTest : public NavigationTest {
 protected:
  void SetUp() override {
    thruster_configuration thruster = gnc::test::thruster();
    thruster.thrust_acceleration = 0.02 / 30.0;
    EXPECT_EQ(inbox_.receive(packet_of({0}, thruster)), Status::kOk);
    EXPECT_EQ(inbox_.receive(packet_of({0}, measurement_of(servicer_state()))), Status::kOk);
    update(0);
    navigation_.expect_maneuver(5, {250 * kSecond}, {0.0, 0.2, 0.0});  // 100 s to 400 s
  }
  static orbit::CartesianState accelerated(const orbit::CartesianState& state, double share, double dt) {
    return filter::propagate_accelerated(state, {0.0, share * 0.02 / 30.0, 0.0}, dt);
  }
  executed_maneuver report(double dv_t) {
    executed_maneuver report{};
    report.maneuver_id = 5;
    report.accepted = dv_t != 0.0 ? 1 : 0;
    report.dv_rtn[1] = dv_t;
    return report;
  }
  const orbit::CartesianState at_begin_ = orbit::propagate_j2(servicer_state(), 100.0).value();
};

TEST_F(FiniteBurnNavigationTest, ABurnActsFromItsBeginOn) {
  update(180);
  EXPECT_LT((navigation_.state().servicer.position_eci - accelerated(at_begin_, 1.0, 80.0).position_eci).norm(), 1e-6);
  update(460);
  const auto after = orbit::propagate_j2(accelerated(at_begin_, 1.0, 300.0), 60.0).value();
  EXPECT_LT((navigation_.state().servicer.position_eci - after.position_eci).norm(), 1e-6);
}

// A measurement at 200 s holds the first third of the burn; the report, 2 % less, comes when it has ended.
TEST_F(FiniteBurnNavigationTest, AReportIsUsedAfterAMeasurementWithinTheBurn) {
  const orbit::CartesianState measured = accelerated(at_begin_, 1.0, 100.0);
  EXPECT_EQ(inbox_.receive(packet_of({200 * kSecond}, measurement_of(measured))), Status::kOk);
  update(240);
  EXPECT_EQ(inbox_.receive(packet_of({250 * kSecond}, report(0.196))), Status::kOk);
  update(420);
  EXPECT_EQ(inbox_.counters().rejected_time, 0);
  const auto after = orbit::propagate_j2(accelerated(measured, (0.98 - 1.0 / 3.0) / (2.0 / 3.0), 200.0), 20.0).value();
  EXPECT_LT((navigation_.state().servicer.velocity_eci - after.velocity_eci).norm(), 1e-8);
}

// A thruster refuses a burn when it should begin, before the time tag of the report.
TEST_F(FiniteBurnNavigationTest, ARefusalComesBeforeTheTimeOfTheBurn) {
  update(60);
  EXPECT_EQ(inbox_.receive(packet_of({250 * kSecond}, report(0.0))), Status::kOk);
  update(120);
  EXPECT_EQ(inbox_.counters().rejected_time, 0);
  const auto expected = orbit::propagate_j2(servicer_state(), 120.0).value();
  EXPECT_LT((navigation_.state().servicer.position_eci - expected.position_eci).norm(), 1e-6);
}

TEST_F(FiniteBurnNavigationTest, AnUnusableThrustIsRefused) {
  for (const double acceleration : {-1e-3, 1e-9, 1e9}) {
    thruster_configuration thruster = gnc::test::thruster();
    thruster.thrust_acceleration = acceleration;
    EXPECT_FALSE(is_valid(thruster)) << acceleration;
  }
  thruster_configuration thruster = gnc::test::thruster();
  EXPECT_TRUE(is_valid(thruster));
  thruster.pause_s = -1.0;
  EXPECT_FALSE(is_valid(thruster));
}

// Hours without a measurement: the epoch of the estimator follows, so that a step's work stays bounded, and both orbits
// remain those of the gravity field of degree 20.
TEST_F(NavigationTest, CoastsForHours) {
  EXPECT_EQ(inbox_.receive(packet_of({0}, measurement_of(servicer_state()))), Status::kOk);
  for (std::int64_t s = 0; s <= 7200; s += 60) update(s);
  ASSERT_TRUE(navigation_.state().valid);
  const filter::Propagation gravity(GpsTime{}, filter::FilterSettings{}.earth, Vector3::UnitX());
  const orbit::CartesianState expected = gravity.coast(servicer_state(), 7200.0);
  // The rotation of the Earth is accurate over segments of ten minutes, and the last ten to twenty are flown under J2.
  EXPECT_LT((navigation_.state().servicer.position_eci - expected.position_eci).norm(), 60.0);
  EXPECT_EQ(navigation_.state().last_measurement.ns, 0);

  executed_maneuver report{};  // of before the anchor: it can no longer be made good, and is counted
  report.accepted = 1;
  EXPECT_EQ(inbox_.receive(packet_of({600 * kSecond}, report)), Status::kOk);
  update(7260);
  EXPECT_EQ(inbox_.counters().rejected_time, 1);
}

// By covariance, not by elapsed time: after a day without measurements the state at 100 m is still useful, and reports
// an uncertainty of metres; at one metre it is not.
TEST_F(NavigationTest, ValidityEndsByCovariance) {
  EXPECT_EQ(inbox_.receive(packet_of({0}, measurement_of(servicer_state()))), Status::kOk);
  update(0);
  update(86400);
  EXPECT_TRUE(navigation_.state().valid);
  EXPECT_GT(navigation_.state().sigma_rtn(1), 1.0);
  EXPECT_LT(navigation_.state().sigma_rtn(1), 25.0);
  EXPECT_EQ(inbox_.receive(packet_of({86460 * kSecond}, measurement_of(servicer_state(), 1.0))), Status::kOk);
  update(86460);
  EXPECT_TRUE(navigation_.state().valid);
  update(2 * 86400);
  EXPECT_FALSE(navigation_.state().valid);
  EXPECT_TRUE(navigation_.state().has_target);
  EXPECT_EQ(inbox_.receive(packet_of({2 * 86400 * kSecond}, measurement_of(servicer_state(), 1.0))), Status::kOk);
  update(2 * 86400 + 60);
  EXPECT_TRUE(navigation_.state().valid);
}

TEST_F(NavigationTest, AMeasurementThatIsNoOrbitChangesNothing) {
  EXPECT_EQ(inbox_.receive(packet_of({0}, measurement_of(servicer_state()))), Status::kOk);
  update(0);
  ideal_navigation message = measurement_of(servicer_state());
  message.servicer_velocity_eci[2] = 20000.0;  // beyond escape
  EXPECT_EQ(inbox_.receive(packet_of({60 * kSecond}, message)), Status::kOk);
  update(60);
  EXPECT_TRUE(navigation_.state().valid);
  EXPECT_EQ(navigation_.state().source, NavigationSource::kPropagated);
  EXPECT_EQ(inbox_.counters().rejected_content, 1);
}

}  // namespace
}  // namespace vbar::fsw::navigation
