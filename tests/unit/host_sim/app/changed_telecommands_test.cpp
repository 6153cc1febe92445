#include "host_sim/app/changed_telecommands.h"

#include <stdexcept>

#include <gmock/gmock.h>

#include "fsw/packets/messages.h"
#include "host_sim/sensors/sensor_kind.h"

namespace vbar::app {
namespace {

using fsw::packets::Apid;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr fsw::GpsTime kStart{1'000'000'000LL};
constexpr fsw::GpsTime kLater{7'000'000'000LL};

/// Guidance, waypoints, two cameras and the mode.
std::vector<twins::Packet> telecommands(std::int32_t waypoints, double camera_value, bool with_mode = true) {
  sensors::Telecommands all(kStart, 1);
  all.add(gnc_configuration{});
  waypoint_table table{};
  table.count = waypoints;
  all.add(table);
  all.add(camera_configuration{}, 0);
  camera_configuration second{};
  second.focal_length_px[0] = camera_value;
  all.add(second, 1);
  if (with_mode) all.add(mode_command{});
  return all.packets();
}

TEST(ChangedTelecommands, AreThoseWithAnotherContentAtTheirTime) {
  const auto changed = changed_telecommands(telecommands(2, 1.0), telecommands(3, 1.0), kLater);
  ASSERT_EQ(changed.size(), 1U);
  const auto packet = fsw::packets::parse_packet(changed.front());
  ASSERT_TRUE(packet.ok());
  EXPECT_EQ(packet.value().header.apid, Apid::kWaypointTable);
  EXPECT_EQ(packet.value().header.time, kLater);
  EXPECT_EQ(packet.value().header.spacecraft, 1);
  EXPECT_EQ(fsw::packets::decode<waypoint_table>(packet.value()).value().count, 3);
  EXPECT_TRUE(changed_telecommands(telecommands(2, 1.0), telecommands(2, 1.0), kLater).empty());
}

TEST(ChangedTelecommands, OneThatWasNotSentIsNew) {
  EXPECT_EQ(changed_telecommands(telecommands(2, 1.0, false), telecommands(2, 1.0), kLater).size(), 1U);
}

TEST(ChangedTelecommands, WhatCannotBeGivenInFlightIsNamed) {
  EXPECT_THAT(
      [] { return changed_telecommands(telecommands(2, 1.0), telecommands(2, 2.0), kLater); },
      ThrowsMessage<std::runtime_error>(HasSubstr("camera_configuration, which is given before the first step")));
  EXPECT_THAT([] { return changed_telecommands(telecommands(2, 1.0), telecommands(2, 1.0, false), kLater); },
              ThrowsMessage<std::runtime_error>(HasSubstr("takes back the telecommand mode_command")));
}

}  // namespace
}  // namespace vbar::app
