#include "host_sim/twins/gnss/oem_encoder.h"

#include <array>
#include <bit>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "host_sim/twins/gnss/system_time.h"

namespace vbar::twins::gnss::oem {
namespace {

std::uint32_t u32(const Bytes& bytes, std::size_t at) {
  return bytes[at] | static_cast<std::uint32_t>(bytes[at + 1]) << 8U |
         static_cast<std::uint32_t>(bytes[at + 2]) << 16U | static_cast<std::uint32_t>(bytes[at + 3]) << 24U;
}
std::uint16_t u16(const Bytes& bytes, std::size_t at) {
  return static_cast<std::uint16_t>(bytes[at] | bytes[at + 1] << 8U);
}
double f64(const Bytes& bytes, std::size_t at) {
  return std::bit_cast<double>(static_cast<std::uint64_t>(u32(bytes, at)) |
                               static_cast<std::uint64_t>(u32(bytes, at + 4)) << 32U);
}

// The CRC bit by bit, as NovAtel's manual prints it.
std::uint32_t crc_by_bits(const Bytes& bytes, std::size_t count) {
  std::uint32_t crc = 0;
  for (std::size_t k = 0; k < count; ++k) {
    crc ^= bytes[k];
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 1U) != 0 ? (crc >> 1U) ^ 0xEDB88320U : crc >> 1U;
  }
  return crc;
}

const Header kHeader{
    .time = gps_time_of(System::kGps, 2098, 427560), .status = TimeStatus::kFine, .position_valid = true};

void expect_framed(const Bytes& bytes, int id, std::size_t body) {
  ASSERT_EQ(bytes.size(), 28 + body + 4);
  EXPECT_EQ(u32(bytes, 0), 0x1C1244AAU);
  EXPECT_EQ(u16(bytes, 4), id);
  EXPECT_EQ(u16(bytes, 8), body);
  EXPECT_EQ(u16(bytes, 14), 2098);
  EXPECT_EQ(u32(bytes, 16), 427560000U);
  EXPECT_EQ(u32(bytes, 28 + body), crc_by_bits(bytes, 28 + body));
}

// A real GPSEPHEM that NovAtel publishes with its decoder's tests (PRN 3, week 2098): the same satellite encoded stands
// at the offsets of the manual. Their text has nine digits.
TEST(OemEncoder, GpsephemAsARealReceiverSendsIt) {
  BroadcastSet set;
  set.issue = 68;
  Ephemeris& e = set.ephemeris;
  e.satellite = {System::kGps, 3};
  e.toe = gps_time_of(System::kGps, 2098, 432000);
  e.sqrt_a = std::sqrt(2.6559425980e7);
  e.delta_n = 4.844487507e-9;
  e.m0 = 5.4111299713e-1;
  e.e = 2.6812178548e-3;
  e.omega = 6.9765460014e-1;
  e.i0 = 9.6490477291e-1;
  e.node_at_toe = -1.0423004440 - fsw::gnss::kEarthRateGps * 432000.0;
  e.group_delay_s = 1.862645149e-9;
  Bytes bytes;
  append_gpsephem(bytes, kHeader, set, kHeader.time);
  expect_framed(bytes, 7, 224);
  EXPECT_EQ(u32(bytes, 28), 3U);
  EXPECT_EQ(f64(bytes, 32), 427560.0);
  EXPECT_EQ(u32(bytes, 44), 68U);
  EXPECT_EQ(u32(bytes, 52), 2098U);
  EXPECT_EQ(f64(bytes, 60), 432000.0);
  EXPECT_NEAR(f64(bytes, 68), 2.6559425980e7, 1e-3);
  EXPECT_EQ(f64(bytes, 84), 5.4111299713e-1);
  EXPECT_NEAR(f64(bytes, 172), -1.0423004440, 1e-9);
  EXPECT_EQ(u32(bytes, 188), 68U);
  EXPECT_EQ(f64(bytes, 192), 432000.0);
  EXPECT_EQ(f64(bytes, 200), 1.862645149e-9);
  EXPECT_NEAR(f64(bytes, 236), 1.458664175e-4, 1e-12);  // the receiver's own corrected mean motion
}

// Lengths and places from the OEM6 manual's tables; RTKLIB reads neither of the two.
TEST(OemEncoder, PositionAndTime) {
  Bytes bytes;
  PositionRecord position;
  position.solved = true;
  position.position_ecef << 1.0, 2.0, 3.0;
  position.velocity_ecef << 4.0, 5.0, 6.0;
  position.satellites_tracked = 21;
  position.satellites_used = 15;
  append_bestxyz(bytes, kHeader, position);
  expect_framed(bytes, 241, 112);
  EXPECT_EQ(u32(bytes, 32), 16U);
  EXPECT_EQ(f64(bytes, 52), 3.0);
  EXPECT_EQ(f64(bytes, 28 + 68), 6.0);
  EXPECT_EQ(bytes[28 + 104], 21);
  EXPECT_EQ(bytes[28 + 105], 15);

  bytes.clear();
  // 427560 s of the week 2098 are 2020-03-26 22:46:00 GPS, 18 s ahead of UTC since the end of 2016.
  const UtcOffset utc = utc_offset_at(kHeader.time);
  EXPECT_EQ(utc.gps_minus_utc_s, 18);
  EXPECT_EQ(utc.change_week, 1929);  // 2016-12-31 was the seventh day of week 1929
  EXPECT_EQ(utc.change_day, 7);
  append_time(bytes, kHeader, {.valid = true, .offset_s = 1e-4, .sigma_s = 1e-8}, utc);
  expect_framed(bytes, 101, 44);
  EXPECT_EQ(f64(bytes, 32), 1e-4);
  EXPECT_EQ(f64(bytes, 48), -18.0);
  EXPECT_EQ(u32(bytes, 56), 2020U);
  EXPECT_EQ((std::array<int, 4>{bytes[60], bytes[61], bytes[62], bytes[63]}), (std::array<int, 4>{3, 26, 22, 45}));
  EXPECT_EQ(u32(bytes, 64), 42000U);
}

// 2008-12-31 was the fourth day of week 1512 (Wednesday); the mission of 2011 flies at 15 s.
TEST(OemEncoder, LeapSecondsOfTheMission) {
  const UtcOffset utc = utc_offset_at(gps_time_of(System::kGps, 1645, 90000));
  EXPECT_EQ(utc.gps_minus_utc_s, 15);
  EXPECT_EQ(utc.change_week, 1512);
  EXPECT_EQ(utc.change_day, 4);
}

// Without time the header says none; an empty RANGE is four bytes of body.
TEST(OemEncoder, UnknownTimeIsNotTold) {
  Bytes bytes;
  append_range(bytes, {.time = kHeader.time}, {});
  ASSERT_EQ(bytes.size(), 36U);
  EXPECT_EQ(bytes[13], 20);
  EXPECT_EQ(u16(bytes, 14), 0);
  EXPECT_EQ(u32(bytes, 16), 0U);
  EXPECT_EQ(u32(bytes, 20), 1U << 19U);  // position invalid
}

}  // namespace
}  // namespace vbar::twins::gnss::oem
