// SimGEN's datagram and lines against bytes and texts written out from the table and from public clients.

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil_drivers/grand/wire/simgen.h"
#include "tests/unit/hil_drivers/grand/generators/wire_test.h"

namespace vbar::grand::wire::test {
namespace {

using fsw::Vector3;
using testing::ElementsAre;
using testing::HasSubstr;

SimgenMotion motion() {
  SimgenMotion m;
  m.vehicle = 2;
  m.sample.time = fsw::Duration{90'061'100'000'000};  // 1 d 01:01:01.1
  m.sample.position_ecef_m = {1, 2, 3};
  m.sample.velocity_ecef_mps = {4, 5, 6};
  m.sample.acceleration_ecef_mps2 = {0.5, -1, 0};
  m.sample.jerk_ecef_mps3 = {1, 1, 1};
  m.sample.yaw_pitch_roll = {2, 2, 2};
  m.sample.angular_rate = {3, 2, 1};
  m.sample.angular_acceleration = {6, 5, 4};
  return m;
}

/// Offsets of the table: 0 type 0, 4 action 1, 8 time 90061100 ms = 0x055e392c, 12 vehicle 2, 16 24 numbers, 208
/// latency, 212 padding.
Bytes datagram() {
  const Bytes one = hex("00 00 00 00 00 00 f0 3f"), two = hex("00 00 00 00 00 00 00 40"),
              three = hex("00 00 00 00 00 00 08 40"), four = hex("00 00 00 00 00 00 10 40"),
              five = hex("00 00 00 00 00 00 14 40"), six = hex("00 00 00 00 00 00 18 40"),
              half = hex("00 00 00 00 00 00 e0 3f"), minus_one = hex("00 00 00 00 00 00 f0 bf"),
              zero = hex("00 00 00 00 00 00 00 00");
  return hex("00 00 00 00 01 00 00 00 2c 39 5e 05 02 00 00 00") + one + two + three + four + five + six + half +
         minus_one + zero + one + one + one + two + two + two + three + two + one + six + five + four + zero + zero +
         zero + hex("00 00 00 00 00 00 00 00");
}

void expect_same(const SimgenMotion& a, const SimgenMotion& b) {
  EXPECT_EQ(a.vehicle, b.vehicle);
  EXPECT_EQ(a.is_timed, b.is_timed);
  EXPECT_EQ(a.sample.time, b.sample.time);
  EXPECT_EQ(a.sample.position_ecef_m, b.sample.position_ecef_m);
  EXPECT_EQ(a.sample.velocity_ecef_mps, b.sample.velocity_ecef_mps);
  EXPECT_EQ(a.sample.acceleration_ecef_mps2, b.sample.acceleration_ecef_mps2);
  EXPECT_EQ(a.sample.jerk_ecef_mps3, b.sample.jerk_ecef_mps3);
  EXPECT_EQ(a.sample.yaw_pitch_roll, b.sample.yaw_pitch_roll);
  EXPECT_EQ(a.sample.angular_rate, b.sample.angular_rate);
  EXPECT_EQ(a.sample.angular_acceleration, b.sample.angular_acceleration);
}

TEST(Simgen, TheDatagramIsThatOfTheTable) {
  EXPECT_EQ(datagram().size(), 216U);
  EXPECT_EQ(encode_mot(motion()), datagram());
  expect_same(decode_mot(datagram()), motion());
}

TEST(Simgen, TheDatagramMayLackItsPadding) {
  Bytes packed = datagram();
  packed.resize(212);
  expect_same(decode_mot(packed), motion());
}

TEST(Simgen, EveryOtherSizeIsRefused) {
  Bytes bytes = datagram();
  bytes.resize(300);
  for (std::size_t size = 0; size <= bytes.size(); ++size) {
    if (size == 212 || size == 216) continue;
    EXPECT_THAT(error_of([&] { decode_mot(std::span(bytes).first(size)); }), HasSubstr("accepted are 216 and 212"));
  }
}

TEST(Simgen, MalformedDatagramsAreRefused) {
  Bytes bytes = datagram();
  bytes[0] = 1;
  EXPECT_THAT(error_of([&] { decode_mot(bytes); }), HasSubstr("type 1 is not 0"));
  bytes = datagram();
  bytes[4] = 2;
  EXPECT_THAT(error_of([&] { decode_mot(bytes); }), HasSubstr("action 2"));
  bytes = datagram();
  bytes[12] = 0;
  EXPECT_THAT(error_of([&] { decode_mot(bytes); }), HasSubstr("vehicle 0 is not from 1"));
  for (std::size_t place = 16; place < 208; place += 8) {
    bytes = datagram();
    const Bytes nan = hex("00 00 00 00 00 00 f8 7f");
    std::copy(nan.begin(), nan.end(), bytes.begin() + static_cast<std::ptrdiff_t>(place));
    EXPECT_THAT(error_of([&] { decode_mot(bytes); }), HasSubstr("is not finite")) << place;
  }
}

// As a public client writes it: day, clock, MOT, vehicle, 24 numbers.
TEST(Simgen, TheMotionAsALine) {
  EXPECT_EQ(mot_line(motion()), "1 01:01:01.100,MOT,v2_m1,1,2,3,4,5,6,0.5,-1,0,1,1,1,2,2,2,3,2,1,6,5,4,0,0,0");
  expect_same(motion_of(parse_simgen_command(mot_line(motion()))), motion());
  // As another one does.
  const SimgenMotion other = motion_of(parse_simgen_command(
      "0 00:00:00.0000,mot,v1_m1, 4288466.6747904532, -2873655.5571095324, -4871760.5248780008,"
      "  3148.5166339857, -4356.3915379860, 5341.2059223289,0,0,0,0.0,0.0,0.0,2.9,0.002,3.1,0,0,0,0,0,0,0,0,0\n"));
  EXPECT_EQ(other.vehicle, 1U);
  EXPECT_EQ(other.sample.position_ecef_m, Vector3(4288466.6747904532, -2873655.5571095324, -4871760.5248780008));
  EXPECT_EQ(other.sample.yaw_pitch_roll, Vector3(2.9, 0.002, 3.1));
}

// Shortest texts that read back exactly, so that both ends compute with the same bits.
TEST(Simgen, TheLineReadsBackExactly) {
  SimgenMotion m = motion();
  m.sample.position_ecef_m = {6778137.0 / 3.0, -1.0 / 7.0, 1e-17};
  m.sample.jerk_ecef_mps3 = {1.0 / 3.0, 5e-324, 1.7976931348623157e308};
  expect_same(motion_of(parse_simgen_command(mot_line(m))), m);
}

TEST(Simgen, ATimeOffTheMillisecondIsNotSent) {
  SimgenMotion m = motion();
  m.sample.time.ns += 1;
  EXPECT_THAT(error_of([&] { encode_mot(m); }), HasSubstr("not a whole number of milliseconds"));
  EXPECT_THAT(error_of([&] { mot_line(m); }), HasSubstr("not a whole number of milliseconds"));
}

TEST(Simgen, TheStartTimeIsThatOfTheTable) {
  const fsw::GpsTime start = fsw::GpsTime{} + fsw::duration_of_seconds(std::int64_t{1645} * 604800 + 2 * 86400 + 57600);
  const std::string line = "START_TIME,19-JUL-2011 16:00:00,02:15:00";
  EXPECT_EQ(start_time_line(start, fsw::duration_of_seconds(8100)), line);
  const SimgenStart read = start_of(parse_simgen_command(line));
  EXPECT_EQ(read.time, start);
  EXPECT_EQ(read.duration, fsw::duration_of_seconds(8100));
  for (const char* bad : {"START_TIME", "START_TIME,19-JUL-2011,02:15:00", "START_TIME,19-JUX-2011 16:00:00,1",
                          "START_TIME,31-JUN-2011 16:00:00,02:15:00", "START_TIME,19-JUL-2011 25:00:00,02:15:00",
                          "START_TIME,19-JUL-2011 16:00:00,x"})
    EXPECT_NE(error_of([&] { start_of(parse_simgen_command(bad)); }), "") << bad;
}

TEST(Simgen, CommandsAreTakenApart) {
  const SimgenCommand end = parse_simgen_command("-,EN,1\r\n");
  EXPECT_EQ(end.name, "EN");
  EXPECT_EQ(end.time, std::nullopt);
  EXPECT_THAT(end.arguments, ElementsAre("1"));
  EXPECT_EQ(parse_simgen_command("tr, 0").name, "TR");
  EXPECT_EQ(parse_simgen_command("12.5,POW_ON").time, fsw::Duration{12'500'000'000});
  for (const char* bad : {"", ",", "-", "-,", "25:61:00,MOT", "1 2 3,MOT"})
    EXPECT_NE(error_of([&] { parse_simgen_command(bad); }), "") << bad;
  EXPECT_THAT(error_of([] { motion_of(parse_simgen_command("-,MOT,w1,1")); }), HasSubstr("2 arguments"));
  std::string line = mot_line(motion());
  line.replace(line.find("v2_m1"), 5, "vx_m1");
  EXPECT_THAT(error_of([&] { motion_of(parse_simgen_command(line)); }), HasSubstr("vehicle \"vx_m1\""));
  line = mot_line(motion());
  line.replace(line.find("0.5"), 3, "nan");
  EXPECT_THAT(error_of([&] { motion_of(parse_simgen_command(line)); }), HasSubstr("number 7 is \"nan\""));
}

TEST(Simgen, RepliesAreTakenApart) {
  EXPECT_EQ(encode_reply({5, "12.3", ""}), "<msg><status>5</status><data>12.3</data></msg>");
  const std::string stream = "<msg> <status> 4 </status> <data>\n 0.100 </data> </msg><msg>";
  ASSERT_EQ(reply_length(stream), stream.size() - 5);
  const SimgenReply reply = parse_reply(stream);
  EXPECT_EQ(reply.status, 4);
  EXPECT_EQ(time_of_data(reply.data), fsw::Duration{100'000'000});
  EXPECT_EQ(parse_reply("<msg><status>2</status><error>No way</error></msg>").error, "No way");
  EXPECT_EQ(parse_reply("<msg><status>2</status><fatal></fatal></msg>").error, "fatal");
  EXPECT_EQ(reply_length("<msg><status>2</status>"), 0U);
  for (const char* bad : {"", "<msg></msg>", "<msg><status>x</status></msg>", "<msg><status></status></msg>",
                          "<status>2</status>", "<msg><status>2</msg>"})
    EXPECT_NE(error_of([&] { parse_reply(bad); }), "") << bad;
  EXPECT_NE(error_of([] { static_cast<void>(reply_length(std::string(70000, 'x'))); }), "");
  for (const char* bad : {"", "soon", "-1", "nan", "1e99"}) EXPECT_NE(error_of([&] { time_of_data(bad); }), "") << bad;
}

}  // namespace
}  // namespace vbar::grand::wire::test
