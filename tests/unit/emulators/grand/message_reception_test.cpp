// GPS: IS-GPS-200N 20.3.3 (subframes of 6 s, frames of 30 s); Galileo OS SIS ICD 2.1, table 36; BeiDou D1 and D2:
// BDS-SIS-ICD-B1I-3.0, 5.2.1 and 5.3.1.

#include "emulators/grand/receiver/message_reception.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "emulators/grand/receiver/receiver_settings.h"
#include "emulators/grand/receiver/serial_line.h"
#include "host_sim/mission/mission_error.h"
#include "host_sim/twins/gnss/system_time.h"
#include "tests/support/gnss_scene.h"

namespace vbar::grand::bench::test {

namespace {

using twins::gnss::SatelliteId;
using twins::gnss::System;

const std::shared_ptr<const twins::gnss::Constellation>& sky() {
  static const auto all = vbar::test::constellation(1);
  return all;
}

std::size_t first_of(System system, bool geostationary = false) {
  for (std::size_t k = 0; k < sky()->size(); ++k)
    if (sky()->id(k).system == system && is_geostationary(sky()->id(k)) == geostationary) return k;
  return 0;
}

fsw::GpsTime at(double since_start_s) {
  return vbar::test::kGnssStart + fsw::nearest_duration(since_start_s);
}

/// Listens from `begin_s` on, but for the given interval; when the set was complete, s after the start.
double complete_s(std::size_t index, double begin_s, double lost_from_s = 1e9, double lost_to_s = 1e9) {
  MessageReception reception(sky()->id(index));
  for (int block = 0; block < 3000; ++block) {
    const double t = begin_s + 0.1 * block;
    const bool locked = t < lost_from_s || t >= lost_to_s;
    if (reception.receive(at(t), locked, *sky(), index).ephemeris) return t;
  }
  return -1.0;
}

// The start is a multiple of 30 s of the GPS week. A reception from the beginning of subframe 1 on is complete with
// subframe 3; one that begins a little later needs the next subframe 1: 18 to 36 s in all.
TEST(MessageReception, GpsNeedsThreeSubframes) {
  const std::size_t gps = first_of(System::kGps);
  EXPECT_NEAR(complete_s(gps, 0.0), 18.0, 0.11);
  EXPECT_NEAR(complete_s(gps, 0.1), 36.0, 0.11);  // subframe 1 of the next frame
  EXPECT_NEAR(complete_s(gps, 6.0), 36.0, 0.11);
  EXPECT_NEAR(complete_s(gps, 6.1), 42.0, 0.11);   // 1 and 2: 35.9 s of listening
  EXPECT_NEAR(complete_s(gps, 12.1), 48.0, 0.11);  // all three: 35.9 s
  EXPECT_NEAR(complete_s(gps, 29.9), 48.0, 0.11);
  for (double begin_s = 0.0; begin_s < 30.0; begin_s += 0.7) {
    const double listened_s = complete_s(gps, begin_s) - begin_s;
    EXPECT_GE(listened_s, 18.0 - 0.11);
    EXPECT_LE(listened_s, 36.0 + 0.11);
  }
}

// A tenth of a second without lock in subframe 2 costs that subframe, nothing else.
TEST(MessageReception, AnInterruptionCostsThePartItFallsInto) {
  const std::size_t gps = first_of(System::kGps);
  EXPECT_NEAR(complete_s(gps, 0.0, 8.0, 8.1), 42.0, 0.11);
  EXPECT_NEAR(complete_s(gps, 0.0, 3.0, 3.1), 36.0, 0.11);
}

TEST(MessageReception, OtherSystemsByTheirOwnPages) {
  // Words 2, 4 in the first four seconds of 30, 1, 3, 5 from 20 to 26 s.
  const std::size_t galileo = first_of(System::kGalileo);
  EXPECT_NEAR(complete_s(galileo, 0.0), 26.0, 0.11);
  EXPECT_NEAR(complete_s(galileo, 1.0), 32.0, 0.11);  // word 2 of the next subframe
  // BeiDou time is 14 s behind GPS time: its frames begin at 14 s of the GPS ones.
  const std::size_t medium = first_of(System::kBeidou);
  EXPECT_NEAR(complete_s(medium, 14.0), 32.0, 0.11);
  // Ten pages of 0.6 s, one every 3 s.
  const std::size_t geostationary = first_of(System::kBeidou, true);
  EXPECT_NEAR(complete_s(geostationary, 14.0), 14.0 + 27.6, 0.11);
}

// The sign of the bits is known after the first two words of a subframe.
TEST(MessageReception, SignOfBitsComesWithThePreamble) {
  const std::size_t gps = first_of(System::kGps);
  MessageReception reception(sky()->id(gps));
  double first_s = -1.0;
  int count = 0;
  for (int block = 0; block < 300; ++block) {
    const double t = 2.0 + 0.1 * block;
    if (!reception.receive(at(t), true, *sky(), gps).sign_of_bits) continue;
    if (first_s < 0.0) first_s = t;
    ++count;
  }
  EXPECT_NEAR(first_s, 7.2, 0.11);
  EXPECT_EQ(count, 5);
}

// Sets change every two hours; parts of two sets do not make one.
TEST(MessageReception, ANewSetReplacesTheOld) {
  const std::size_t gps = first_of(System::kGps);
  MessageReception reception(sky()->id(gps));
  // 16:00 is a change; half a minute before it one set, after it the other.
  std::vector<double> complete;
  for (int block = 0; block < 1200; ++block) {
    const double t = -54.0 + 0.1 * block;
    if (reception.receive(at(t), true, *sky(), gps).ephemeris) complete.push_back(t);
  }
  ASSERT_EQ(complete.size(), 2U);
  EXPECT_NEAR(complete[0], -24.0, 0.11);  // subframes 2 and 3, then 1 of the next frame
  EXPECT_NEAR(complete[1], 18.0, 0.11);
  EXPECT_EQ(reception.set()->ephemeris.toe, sky()->broadcast_set(gps, at(10.0)).ephemeris.toe);
  EXPECT_EQ(reception.set_transmitted(), at(0.0));
}

}  // namespace

namespace {

ReceiverSettings read(std::string_view text) {
  const toml::table document = toml::parse(text);
  const mission::TableReader reader(document, "scenario.toml");
  const mission::TableReader section = reader.table("receiver");
  const ReceiverSettings settings = read_receiver_settings(section);
  reader.finish();
  return settings;
}

TEST(ReceiverSettings, EveryKeyHasADefault) {
  EXPECT_EQ(read("[receiver]"), ReceiverSettings{});
}

TEST(ReceiverSettings, ReadsEveryTable) {
  const ReceiverSettings settings = read(R"(
[receiver]
steering_bandwidth_hz = 0.05
stored = "ephemerides"
week_shift = 1024
time_shift_s = 1
loops = { carrier_order = 2, carrier_bandwidth_hz = 10.0, smoothing_s = 50.0 }
search = { engines = 8, threshold_dbhz = 30.0 }
line = { baud = 9600, buffer_bytes = 4096 }
clock = { initial_offset_ms = 0.1 }
)");
  EXPECT_EQ(settings.loops.carrier_order, 2);
  EXPECT_EQ(settings.loops.smoothing_s, 50.0);
  EXPECT_EQ(settings.search.engines, 8);
  EXPECT_EQ(settings.line.baud, 9600U);
  EXPECT_EQ(settings.clock.initial_offset_ms, 0.1);
  EXPECT_EQ(settings.stored, StoredData::kEphemerides);
  EXPECT_EQ(settings.week_shift, 1024);
  EXPECT_EQ(settings.time_shift_s, 1);
}

TEST(ReceiverSettings, RefusesWithThePlace) {
  const auto refusal = [](std::string_view text) -> std::string {
    try {
      read(text);
    } catch (const mission::MissionError& error) {
      return error.what();
    }
    return "";
  };
  using ::testing::HasSubstr;
  EXPECT_THAT(refusal("[receiver]\nline = { baud = 12345 }"), HasSubstr("scenario.toml:2"));
  EXPECT_THAT(refusal("[receiver]\nline = { baud = 12345 }"), HasSubstr("receiver.line.baud"));
  EXPECT_THAT(refusal("[receiver]\nloops = { carrier_order = 4 }"), HasSubstr("receiver.loops.carrier_order"));
  EXPECT_THAT(refusal("[receiver]\nloops = { carrier_bandwidth_hz = nan }"), HasSubstr("carrier_bandwidth_hz"));
  EXPECT_THAT(refusal("[receiver]\nloop = { }"), HasSubstr("receiver.loop"));
  EXPECT_THAT(refusal("[receiver]\nline = { computing_ms = 5.0 }"), HasSubstr("computing_spread_ms"));
}

}  // namespace

namespace {

SerialLine line(unsigned baud, int buffer = 4096) {
  return {baud, buffer, engine::RandomStream(1, "test/line")};
}

// 8N1: a byte is ten bits, at 9600 baud 1.0417 ms.
TEST(SerialLine, BytesLeaveAtTheBaudRate) {
  SerialLine com = line(9600);
  ASSERT_TRUE(com.queue(Bytes(960, 0x55), 1'000'000'000));
  EXPECT_EQ(com.take(1'000'000'000, 0).size(), 0U);
  EXPECT_EQ(com.take(1'001'041'666, 0).size(), 0U);
  EXPECT_EQ(com.take(1'001'041'667, 0).size(), 1U);
  EXPECT_EQ(com.take(1'500'000'000, 0).size(), 479U);
  EXPECT_EQ(com.take(2'000'000'000, 0).size(), 480U);
  EXPECT_FALSE(com.busy(2'000'000'000));
}

TEST(SerialLine, MessagesFollowEachOther) {
  SerialLine com = line(115200);
  ASSERT_TRUE(com.queue(Bytes(1152, 1), 0));
  ASSERT_TRUE(com.queue(Bytes(1152, 2), 50'000'000));  // 50 ms later, while the first takes 100 ms
  const Bytes first = com.take(100'000'000, 0);
  EXPECT_EQ(first, Bytes(1152, 1));
  EXPECT_EQ(com.take(200'000'000, 0), Bytes(1152, 2));
}

TEST(SerialLine, AFullBufferDropsTheWholeMessage) {
  SerialLine com = line(9600, 1000);
  EXPECT_TRUE(com.queue(Bytes(700, 1), 0));
  EXPECT_FALSE(com.queue(Bytes(400, 2), 0));
  EXPECT_TRUE(com.queue(Bytes(300, 3), 0));
  // 480 bytes leave in half a second.
  EXPECT_TRUE(com.queue(Bytes(400, 4), 500'000'000));
  const Bytes all = com.take(100'000'000'000, 0);
  EXPECT_EQ(all.size(), 1400U);
  EXPECT_EQ(std::count(all.begin(), all.end(), 2), 0);
}

TEST(SerialLine, AListenerAtAnotherRateHearsNoise) {
  SerialLine com = line(115200);
  com.queue(Bytes(1000, 0x42), 0);
  const Bytes heard = com.take(1'000'000'000, 57600);
  EXPECT_EQ(heard.size(), 500U);
  EXPECT_LT(std::count(heard.begin(), heard.end(), 0x42), 20);
}

}  // namespace

}  // namespace vbar::grand::bench::test
