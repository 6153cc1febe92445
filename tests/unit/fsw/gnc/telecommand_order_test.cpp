// The order in which the telecommands of a mission arrive, and the steps over which they are spread, have no effect:
// from the step after the last of them on, every output is the same byte for byte. Acknowledgments excepted, which
// belong to the step of arrival.

#include <algorithm>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "tests/unit/fsw/gnc/configurations.h"
#include "tests/unit/fsw/gnc/small_world.h"

namespace vbar::fsw::gnc::test {
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
          packet_of(kEpoch, pose()),
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
}  // namespace vbar::fsw::gnc::test
