// The store of telecommands: the newest valid one of every kind and unit is in force, each is acknowledged, and a
// refused one changes nothing.

#include "fsw/messaging/telecommands.h"

#include <algorithm>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "fsw/gnc/telecommand_checks.h"
#include "tests/unit/fsw/gnc/small_world.h"
#include "tests/unit/fsw/messaging/configurations.h"

namespace vbar::fsw::messaging {

using namespace gnc::test;

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
    telecommands_.update({ns}, inbox_, gnc::telecommand_rules());
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
  send(1, gnc::test::pose());
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
  send(1, gnc::test::pose());
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
  auto keypoints = gnc::test::pose();
  bearings.exposure_s = 0.2;
  keypoints.exposure_s = 1e-5;
  send(1, bearings);
  send(1, keypoints);
  send(1, navigation(kOwnAndKeypoints + navigation_configuration::kUseBearings));
  for (const auto& acknowledgment : step(1)) EXPECT_EQ(acknowledgment.status, telemetry_telecommand::kStatusAccepted);
}

TEST_F(TelecommandsTest, OfTwoThatContradictTheLaterOfTheListIsRefused) {
  constexpr std::int32_t kBoth = kOwnAndKeypoints + navigation_configuration::kUseBearings;
  send(1, gnc::test::pose(), 0, 1);
  send(1, navigation(kBoth));
  send(1, angles_only(), 0, 1);
  const auto acknowledgments = step(1);
  ASSERT_EQ(acknowledgments.size(), 3U);  // in the order of the list: navigation, bearings, keypoints
  EXPECT_EQ(acknowledgments[0].status, telemetry_telecommand::kStatusAccepted);
  EXPECT_EQ(acknowledgments[1].status, telemetry_telecommand::kStatusAccepted);
  EXPECT_EQ(acknowledgments[2].status, telemetry_telecommand::kStatusContradiction);
  EXPECT_EQ(telecommands_.in_force<pose_configuration>(1), nullptr);
  // Of another camera they agree.
  send(2, gnc::test::pose(), 0, 0);
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

// The order in which the telecommands of a mission arrive, and the steps over which they are spread, have no effect:
// from the step after the last of them on, every output is the same byte for byte. Acknowledgments excepted, which
// belong to the step of arrival.

namespace {

constexpr int kArrivalSteps = 3;
constexpr int kOrders = 150;
const Vector6 kStart = (Vector6() << 0, -100, 0, 3, 0, 3).finished();
const Vector6 kNear = (Vector6() << -0.5, -10, 0, 2, 0, 1).finished();

/// The step in which each packet of a mission arrives, in the order of arrival.
struct Arrival {
  std::size_t packet;
  int step;
};

std::vector<Arrival> any_order(std::size_t packets, std::mt19937_64& random) {
  std::vector<Arrival> arrivals;
  for (std::size_t k = 0; k < packets; ++k) arrivals.push_back({k, static_cast<int>(random() % kArrivalSteps)});
  std::shuffle(arrivals.begin(), arrivals.end(), random);
  return arrivals;
}

std::string described(const std::vector<Arrival>& arrivals) {
  std::string text;
  for (const Arrival& arrival : arrivals) {
    text += std::to_string(arrival.packet) + " in step " + std::to_string(arrival.step) + ", ";
  }
  return text;
}

bool is_acknowledgment(const Bytes& packet) {
  return packets::parse_packet(packet).value().header.apid == packets::Apid::kTelemetryTelecommand;
}

/// All outputs of a flight after the steps of arrival, in which nothing is measured.
struct Flown {
  std::vector<Bytes> packets;
  Answer last;
  int acknowledged = 0;
};

Flown fly(const std::vector<Bytes>& telecommands, const std::vector<Arrival>& arrivals, int steps) {
  Flight flight(kStart);
  Flown flown;
  flight.measures = false;
  for (int step = 0; step < kArrivalSteps; ++step) {
    for (const Arrival& arrival : arrivals) {
      if (arrival.step != step) continue;
      EXPECT_EQ(flight.article.deliver(telecommands[arrival.packet]), 0);
    }
    for (const auto& acknowledgment : flight.step().acknowledgments) {
      EXPECT_EQ(acknowledgment.status, telemetry_telecommand::kStatusAccepted) << acknowledgment.apid;
      ++flown.acknowledged;
    }
  }
  flight.measures = true;
  for (int step = 0; step < steps; ++step) {
    flown.last = flight.step();
    for (const Bytes& packet : flown.last.packets) {
      EXPECT_FALSE(is_acknowledgment(packet));
      flown.packets.push_back(packet);
    }
  }
  return flown;
}

/// The telecommands of a mission as in a simulation: one time tag for all of them.
std::vector<Bytes> mission_of(std::int32_t sources, const waypoint_table& table, std::int8_t commanded_mode) {
  gnc_configuration guidance = configuration();
  guidance.minimum_dv = 2e-6;
  return {packet_of(kEpoch, navigation(sources)),
          packet_of(kEpoch, earth()),
          packet_of(kEpoch, thruster()),
          packet_of(kEpoch, receiver()),
          packet_of(kEpoch, carrier()),
          packet_of(kEpoch, target_shape()),
          packet_of(kEpoch, camera()),
          packet_of(kEpoch, angles_only()),
          packet_of(kEpoch, gnc::test::pose()),
          packet_of(kEpoch, target(kStart)),
          packet_of(kEpoch, table),
          packet_of(kEpoch, guidance),
          packet_of(kEpoch, mode(commanded_mode))};
}

/// Flies the mission with its packets in the order of `telecommands` in the first step, and in many others.
Flown expect_same_in_any_order(const std::vector<Bytes>& telecommands, int steps) {
  std::vector<Arrival> in_order;
  for (std::size_t k = 0; k < telecommands.size(); ++k) in_order.push_back({k, 0});
  Flown reference = fly(telecommands, in_order, steps);
  EXPECT_EQ(reference.acknowledged, static_cast<int>(telecommands.size()));
  std::mt19937_64 random(20110718);
  for (int order = 0; order < kOrders; ++order) {
    const std::vector<Arrival> arrivals = any_order(telecommands.size(), random);
    const Flown flown = fly(telecommands, arrivals, steps);
    EXPECT_EQ(flown.acknowledged, static_cast<int>(telecommands.size())) << described(arrivals);
    EXPECT_TRUE(flown.packets == reference.packets) << described(arrivals);
    if (::testing::Test::HasFailure()) break;
  }
  return reference;
}

TEST(TelecommandOrder, HasNoEffectOnAnApproach) {
  const auto table = table_of({waypoint_at(7, 30, 0, kStart), waypoint_at(8, 3 * 3600, 1, kNear)});
  const Flown flown =
      expect_same_in_any_order(mission_of(navigation_configuration::kUseIdeal, table, mode_command::kModeApproach), 12);
  EXPECT_EQ(flown.last.control.mode, mode_command::kModeApproach);
  EXPECT_EQ(flown.last.control.waypoint_index, 8);
  EXPECT_EQ(flown.last.navigation.valid, 1);
  EXPECT_GT(flown.last.control.planned_dv + flown.last.control.commanded_dv, 0.0);
}

// The waypoint to be kept is reached in the second step: the command may arrive before it, with it or after it, and
// with or without the table.
TEST(TelecommandOrder, HasNoEffectOnStationKeeping) {
  const auto table = table_of({waypoint_at(7, 60, 0, kStart), waypoint_at(8, 3 * 3600, 1, kNear)});
  const Flown flown = expect_same_in_any_order(
      mission_of(navigation_configuration::kUseIdeal, table, mode_command::kModeStationKeeping), 12);
  EXPECT_EQ(flown.last.control.mode, mode_command::kModeStationKeeping);
}

TEST(TelecommandOrder, HasNoEffectOnATableThatHasPassed) {
  const auto table = table_of({waypoint_at(7, 30, 0, kStart)});
  const Flown flown =
      expect_same_in_any_order(mission_of(navigation_configuration::kUseIdeal, table, mode_command::kModeApproach), 12);
  EXPECT_EQ(flown.last.control.mode, mode_command::kModeStationKeeping);
}

}  // namespace

}  // namespace vbar::fsw::messaging
