// The store of telecommands: the newest valid one of every kind and unit is in force, each is acknowledged, and a
// refused one changes nothing.

#include "fsw/gnc/telecommands.h"
#include "fsw/gnc/telecommand_checks.h"

#include "tests/unit/fsw/gnc/configurations.h"
#include "tests/unit/fsw/gnc/small_world.h"

namespace vbar::fsw::gnc::test {
namespace {

using packets::Apid;

constexpr std::int32_t kOwnAndKeypoints =
    std::int32_t{navigation_configuration::kUseOwnGnss} + navigation_configuration::kUseKeypoints;

class TelecommandsTest : public ::testing::Test {
 protected:
  template <class Message>
  void send(std::int64_t ns, const Message& message, std::uint16_t sequence = 0, std::uint8_t unit = 0) {
    EXPECT_EQ(inbox_.receive(packet_of({ns}, message, sequence, kServicer, unit)), Status::kOk);
  }
  /// The acknowledgments of a step at `ns`.
  std::vector<telemetry_telecommand> step(std::int64_t ns) {
    sent_.clear();
    telecommands_.update({ns}, inbox_, telecommand_rules());
    telecommands_.report(outbox_, step_++, {ns});
    inbox_.clear(GpsTime{});
    return sent_;
  }
  /// The status of the only telecommand of a step.
  int status_of_step(std::int64_t ns) {
    const auto acknowledgments = step(ns);
    EXPECT_EQ(acknowledgments.size(), 1U);
    return acknowledgments.empty() ? -1 : acknowledgments.front().status;
  }
  static void sink(void* sent, const std::uint8_t* packet, std::size_t size) {
    const auto view = packets::parse_packet(std::span(packet, size));
    ASSERT_TRUE(view.ok());
    const auto message = packets::decode<telemetry_telecommand>(view.value());
    ASSERT_TRUE(message.ok());
    static_cast<std::vector<telemetry_telecommand>*>(sent)->push_back(message.value());
  }

  std::vector<telemetry_telecommand> sent_;
  Inbox inbox_{kServicer};
  Outbox outbox_{kServicer, &TelecommandsTest::sink, &sent_};
  Telecommands telecommands_;
  std::int64_t step_ = 0;
};

TEST_F(TelecommandsTest, AnAcknowledgmentIdentifiesItsTelecommand) {
  send(40, mode(3), 7);
  const auto acknowledgments = step(50);
  ASSERT_EQ(acknowledgments.size(), 1U);
  EXPECT_EQ(acknowledgments[0].step, 0);
  EXPECT_EQ(acknowledgments[0].apid, static_cast<int>(Apid::kModeCommand));
  EXPECT_EQ(acknowledgments[0].time_tag_gps_ns, 40);
  EXPECT_EQ(acknowledgments[0].sequence_count, 7);
  EXPECT_EQ(acknowledgments[0].unit, 0);
  EXPECT_EQ(acknowledgments[0].status, telemetry_telecommand::kStatusAccepted);
  EXPECT_TRUE(telecommands_.is_new<mode_command>());
  EXPECT_EQ(telecommands_.in_force<mode_command>()->mode, 3);
  EXPECT_EQ(telecommands_.time_of<mode_command>().ns, 40);

  EXPECT_TRUE(step(60).empty());  // once
  EXPECT_FALSE(telecommands_.is_new<mode_command>());
  EXPECT_NE(telecommands_.in_force<mode_command>(), nullptr);
}

TEST_F(TelecommandsTest, EveryKindIsStored) {
  send(1, navigation(kOwnAndKeypoints));
  send(1, earth());
  send(1, thruster());
  send(1, receiver());
  send(1, carrier());
  send(1, target_shape());
  send(1, camera());
  send(1, angles_only());
  send(1, pose());
  send(1, ranges());
  send(1, target(SmallWorld(Vector6::Constant(100.0))));
  send(1, table_of({waypoint_at(1, 60, 0, Vector6::Zero())}));
  send(1, configuration());
  send(1, safety());
  send(1, fault_command{});
  send(1, mode(1));
  std::size_t kinds = 0;
  packets::for_each_telecommand([&]<class Message>() { ++kinds; });
  const auto acknowledgments = step(1);
  ASSERT_EQ(acknowledgments.size(), kinds);
  for (std::size_t k = 0; k < kinds; ++k) {
    EXPECT_EQ(acknowledgments[k].status, telemetry_telecommand::kStatusAccepted) << acknowledgments[k].apid;
    EXPECT_TRUE(k == 0 || acknowledgments[k - 1].apid < acknowledgments[k].apid);
  }
  packets::for_each_telecommand(
      [&]<class Message>() { EXPECT_NE(telecommands_.in_force<Message>(), nullptr) << Message::getTypeName(); });
}

TEST_F(TelecommandsTest, ARefusedOneLeavesThePreviousInForce) {
  send(1, mode(1));
  EXPECT_EQ(status_of_step(1), telemetry_telecommand::kStatusAccepted);
  send(2, mode(5));
  EXPECT_EQ(status_of_step(2), telemetry_telecommand::kStatusOutOfRange);
  send(9, mode(3));
  EXPECT_EQ(status_of_step(3), telemetry_telecommand::kStatusFuture);
  send(2, mode(3), 0, 1);
  EXPECT_EQ(status_of_step(4), telemetry_telecommand::kStatusUnknownUnit);
  send(0, mode(3));
  EXPECT_EQ(status_of_step(5), telemetry_telecommand::kStatusSuperseded);
  EXPECT_EQ(telecommands_.in_force<mode_command>()->mode, 1);
  EXPECT_FALSE(telecommands_.is_new<mode_command>());
  EXPECT_EQ(inbox_.counters().rejected_content, 2);
  EXPECT_EQ(inbox_.counters().rejected_time, 2);
}

// The count wraps at 14 bits: 0 follows 16383.
TEST_F(TelecommandsTest, OfOneInstantTheLaterCountIsInForce) {
  send(1, mode(1), 0x3FFF);
  step(1);
  send(1, mode(3), 0);
  EXPECT_EQ(status_of_step(2), telemetry_telecommand::kStatusAccepted);
  send(1, mode(2), 0x3FFE);
  EXPECT_EQ(status_of_step(3), telemetry_telecommand::kStatusSuperseded);
  EXPECT_EQ(telecommands_.in_force<mode_command>()->mode, 3);
}

TEST_F(TelecommandsTest, CamerasHaveTwoUnits) {
  camera_configuration second = camera();
  second.width = 640;
  send(1, camera(), 0, 0);
  send(1, second, 0, 1);
  send(1, second, 0, 2);
  const auto acknowledgments = step(1);
  ASSERT_EQ(acknowledgments.size(), 3U);
  EXPECT_EQ(acknowledgments[1].unit, 1);
  EXPECT_EQ(acknowledgments[1].status, telemetry_telecommand::kStatusAccepted);
  EXPECT_EQ(acknowledgments[2].status, telemetry_telecommand::kStatusUnknownUnit);
  EXPECT_EQ(telecommands_.in_force<camera_configuration>(0)->width, camera().width);
  EXPECT_EQ(telecommands_.in_force<camera_configuration>(1)->width, 640);
}

// An image feeds one source: bearings and keypoints of one camera contradict each other once both are selected.
TEST_F(TelecommandsTest, AContradictionIsRefusedAndTheOldOneStays) {
  constexpr std::int32_t kBoth = kOwnAndKeypoints + navigation_configuration::kUseBearings;
  send(1, angles_only());
  send(1, pose());
  send(1, navigation(kOwnAndKeypoints));
  for (const auto& acknowledgment : step(1)) EXPECT_EQ(acknowledgment.status, telemetry_telecommand::kStatusAccepted);
  send(2, navigation(kBoth));
  EXPECT_EQ(status_of_step(2), telemetry_telecommand::kStatusContradiction);
  EXPECT_EQ(telecommands_.in_force<navigation_configuration>()->sources, kOwnAndKeypoints);
  EXPECT_FALSE(telecommands_.has_changed());
  EXPECT_EQ(inbox_.counters().rejected_content, 1);
}

TEST_F(TelecommandsTest, ACameraWithTwoExposuresFeedsBoth) {
  auto bearings = angles_only();
  auto keypoints = pose();
  bearings.exposure_s = 0.2;
  keypoints.exposure_s = 1e-5;
  send(1, bearings);
  send(1, keypoints);
  send(1, navigation(kOwnAndKeypoints + navigation_configuration::kUseBearings));
  for (const auto& acknowledgment : step(1)) EXPECT_EQ(acknowledgment.status, telemetry_telecommand::kStatusAccepted);
}

TEST_F(TelecommandsTest, OfTwoThatContradictTheLaterOfTheListIsRefused) {
  constexpr std::int32_t kBoth = kOwnAndKeypoints + navigation_configuration::kUseBearings;
  send(1, pose(), 0, 1);
  send(1, navigation(kBoth));
  send(1, angles_only(), 0, 1);
  const auto acknowledgments = step(1);
  ASSERT_EQ(acknowledgments.size(), 3U);  // in the order of the list: navigation, bearings, keypoints
  EXPECT_EQ(acknowledgments[0].status, telemetry_telecommand::kStatusAccepted);
  EXPECT_EQ(acknowledgments[1].status, telemetry_telecommand::kStatusAccepted);
  EXPECT_EQ(acknowledgments[2].status, telemetry_telecommand::kStatusContradiction);
  EXPECT_EQ(telecommands_.in_force<pose_configuration>(1), nullptr);
  // Of another camera they agree.
  send(2, pose(), 0, 0);
  EXPECT_EQ(status_of_step(2), telemetry_telecommand::kStatusAccepted);
}

TEST_F(TelecommandsTest, SourcesAreKnownAndIdealNavigationStandsAlone) {
  for (const std::int32_t sources :
       {64, -1, std::int32_t{navigation_configuration::kUseIdeal} + navigation_configuration::kUseOwnGnss}) {
    send(sources == -1 ? 2 : 1, navigation(sources));
    EXPECT_EQ(status_of_step(3), telemetry_telecommand::kStatusOutOfRange) << sources;
  }
  send(3, navigation(0));  // none: the state is propagated
  EXPECT_EQ(status_of_step(3), telemetry_telecommand::kStatusAccepted);
}

TEST_F(TelecommandsTest, AnAprioriOrbitIsOfOneOfTwoKinds) {
  const Vector6 a_roe_m = Vector6::Constant(3.0);
  send(1, target(a_roe_m));
  EXPECT_EQ(status_of_step(1), telemetry_telecommand::kStatusAccepted);
  for (const double sigma : {0.0, -1.0, 1e30}) {
    target_apriori spoiled = target(a_roe_m);
    spoiled.sigma_a_roe_m[3] = sigma;
    send(2, spoiled);
    EXPECT_EQ(status_of_step(2), telemetry_telecommand::kStatusOutOfRange) << sigma;
  }
  target_apriori no_kind = target(a_roe_m);
  no_kind.kind = 2;
  send(2, no_kind);
  EXPECT_EQ(status_of_step(2), telemetry_telecommand::kStatusOutOfRange);
  target_apriori no_orbit = target(a_roe_m);
  no_orbit.kind = target_apriori::kKindOrbit;  // its state is zero
  send(2, no_orbit);
  EXPECT_EQ(status_of_step(2), telemetry_telecommand::kStatusOutOfRange);
  target_apriori far = target(a_roe_m);
  far.mean_a_roe_m[1] = 1e7;
  send(2, far);
  EXPECT_EQ(status_of_step(2), telemetry_telecommand::kStatusOutOfRange);
  EXPECT_EQ(telecommands_.in_force<target_apriori>()->mean_a_roe_m[1], 3.0);
}

// As many as fit the queues are acknowledged in one step.
TEST_F(TelecommandsTest, AllOfAFullInboxAreAcknowledged) {
  std::size_t sent = 0;
  packets::for_each_telecommand([&]<class Message>() {
    for (std::uint16_t k = 0; k < Inbox::kCapacity<Message>; ++k, ++sent) send(1, Message{}, k);
  });
  EXPECT_EQ(step(1).size(), sent);
}

}  // namespace
}  // namespace vbar::fsw::gnc::test
