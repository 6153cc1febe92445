// The packet library in C, generated from vbar.lcm by a program of this project, against the types that lcm-gen makes
// of the same file.

#include <array>
#include <cstring>

#include <gtest/gtest.h>

#include "fsw/packets/messages.h"
#include "vbar_packets.h"

namespace vbar::fsw::packets {
namespace {

PacketView view_of(std::span<const std::uint8_t> bytes) {
  const Result<PacketView> view = parse_packet(bytes);
  EXPECT_TRUE(view.ok());
  return view.value();
}

TEST(CPackets, HaveLcmsHashesAndSizes) {
#define EXPECT_LCM(message, MESSAGE)                                                          \
  EXPECT_EQ(VBAR_HASH_##MESSAGE, static_cast<std::uint64_t>(::vbar::message::getHash()));     \
  EXPECT_EQ(VBAR_BYTES_##MESSAGE, static_cast<unsigned>(::vbar::message{}.getEncodedSize())); \
  EXPECT_EQ(VBAR_APID_##MESSAGE, static_cast<unsigned>(MessageTraits<::vbar::message>::kApid));
  // One of each kind of field: numbers, arrays, bytes, floats, structs in an array.
  EXPECT_LCM(tick, TICK)
  EXPECT_LCM(ideal_navigation, IDEAL_NAVIGATION)
  EXPECT_LCM(gnss_bytes, GNSS_BYTES)
  EXPECT_LCM(image_tile, IMAGE_TILE)
  EXPECT_LCM(waypoint_table, WAYPOINT_TABLE)
  EXPECT_LCM(target_model, TARGET_MODEL)
  EXPECT_LCM(telemetry_pose, TELEMETRY_POSE)
  EXPECT_LCM(telemetry_event, TELEMETRY_EVENT)
#undef EXPECT_LCM
}

TEST(CPackets, AreReadAsLcmReadsThem) {
  ::vbar::waypoint_table table{};
  table.count = 2;
  table.reference_semi_major_axis_m = 7.1e6;
  table.waypoints[1].index = -5;
  table.waypoints[1].control_mode = ::vbar::waypoint::kSolverNone;
  table.waypoints[1].a_roe_m[3] = 0.1;
  table.waypoints[15].keep_out_radius_m = 2.5;
  std::array<std::uint8_t, kMaxPacketBytes> bytes{};
  PacketHeader header;
  header.sequence_count = 16383;
  header.time.ns = -7;
  header.spacecraft = 200;
  header.unit = 1;
  const Result<std::size_t> size = encode(header, table, bytes);
  ASSERT_TRUE(size.ok());
  vbar_packet packet;
  ASSERT_TRUE(vbar_read_packet(bytes.data(), size.value(), &packet));
  EXPECT_EQ(packet.header.apid, VBAR_APID_WAYPOINT_TABLE);
  EXPECT_EQ(packet.header.sequence_count, 16383);
  EXPECT_EQ(packet.header.gps_time_ns, -7);
  EXPECT_EQ(packet.header.spacecraft, 200);
  EXPECT_EQ(packet.header.unit, 1);
  vbar_waypoint_table read;
  ASSERT_TRUE(vbar_read_waypoint_table(&packet, &read));
  EXPECT_EQ(read.count, 2);
  EXPECT_EQ(read.reference_semi_major_axis_m, 7.1e6);
  EXPECT_EQ(read.waypoints[1].index, -5);
  EXPECT_EQ(read.waypoints[1].control_mode, VBAR_WAYPOINT_SOLVER_NONE);
  EXPECT_EQ(read.waypoints[1].a_roe_m[3], 0.1);
  EXPECT_EQ(read.waypoints[15].keep_out_radius_m, 2.5);
  vbar_tick tick;
  EXPECT_FALSE(vbar_read_tick(&packet, &tick)) << "another type";
}

TEST(CPackets, AreWrittenAsLcmWritesThem) {
  vbar_maneuver_command command{};
  command.maneuver_id = -3;
  command.waypoint_index = 8;
  command.solver = VBAR_WAYPOINT_SOLVER_CLOSED_FORM;
  command.dv_rtn[2] = -0.25;
  vbar_packet_header header{};
  header.sequence_count = 12;
  header.gps_time_ns = 1'000'000'000'000'000'001;
  header.spacecraft = 3;
  std::array<std::uint8_t, VBAR_MAX_PACKET_BYTES> bytes{};
  const std::size_t size = vbar_write_maneuver_command(bytes.data(), &header, &command);
  const PacketView view = view_of(std::span(bytes).first(size));
  EXPECT_EQ(view.header.sequence_count, 12);
  EXPECT_EQ(view.header.time.ns, 1'000'000'000'000'000'001);
  const auto message = decode<::vbar::maneuver_command>(view);
  ASSERT_TRUE(message.ok());
  EXPECT_EQ(message.value().maneuver_id, -3);
  EXPECT_EQ(message.value().waypoint_index, 8);
  EXPECT_EQ(message.value().solver, ::vbar::waypoint::kSolverClosedForm);
  EXPECT_EQ(message.value().dv_rtn[2], -0.25);
}

TEST(CPackets, RefuseDamageOtherSizesAndWhatIsNotFinite) {
  ::vbar::range_measurement range{};
  range.range_m = 12.5;
  std::array<std::uint8_t, kMaxPacketBytes> bytes{};
  const std::size_t size = encode(PacketHeader{}, range, bytes).value();
  vbar_packet packet;
  for (std::size_t bit = 0; bit < 8 * size; ++bit) {
    auto damaged = bytes;
    damaged[bit / 8] = static_cast<std::uint8_t>(damaged[bit / 8] ^ (1U << (bit % 8)));
    EXPECT_FALSE(vbar_read_packet(damaged.data(), size, &packet)) << bit;
  }
  for (std::size_t shorter = 0; shorter < size; ++shorter) {
    EXPECT_FALSE(vbar_read_packet(bytes.data(), shorter, &packet)) << shorter;
  }
  vbar_range_measurement message{};
  message.range_m = __builtin_nan("");
  vbar_packet_header header{};
  const std::size_t written = vbar_write_range_measurement(bytes.data(), &header, &message);
  ASSERT_TRUE(vbar_read_packet(bytes.data(), written, &packet));
  EXPECT_FALSE(vbar_read_range_measurement(&packet, &message));
}

}  // namespace
}  // namespace vbar::fsw::packets
