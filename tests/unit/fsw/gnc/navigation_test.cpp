// Measurements and own maneuvers are folded in at their own times; without measurements the state coasts and says so.

#include "fsw/gnc/navigation.h"

#include "fsw/orbit/propagate.h"
#include "fsw/orbit/rtn.h"
#include "tests/unit/fsw/gnc/packet_factory.h"

namespace vbar::fsw::gnc {
namespace {

using test::kServicer;
using test::packet_of;

constexpr std::int64_t kSecond = kNanosecondsPerSecond;

orbit::CartesianState servicer_state() {
  orbit::CartesianState state;  // the mission's servicer at the epoch, rounded
  state.position_eci = {12161.8, -7076153.6, -84606.6};
  state.velocity_eci = {-1068.57, -90.58, 7433.74};
  return state;
}

ideal_navigation measurement_of(const orbit::CartesianState& servicer) {
  ideal_navigation message{};
  for (int k = 0; k < 3; ++k) {
    message.servicer_position_eci[k] = servicer.position_eci(k);
    message.servicer_velocity_eci[k] = servicer.velocity_eci(k);
    message.target_position_eci[k] = servicer.position_eci(k) + (k == 1 ? 100.0 : 0.0);
    message.target_velocity_eci[k] = servicer.velocity_eci(k);
  }
  return message;
}

class NavigationTest : public ::testing::Test {
 protected:
  void update(std::int64_t seconds) {
    navigation_.update({seconds * kSecond}, inbox_);
    inbox_.clear();
  }
  Inbox inbox_{kServicer};
  Navigation navigation_;
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

}  // namespace
}  // namespace vbar::fsw::gnc
