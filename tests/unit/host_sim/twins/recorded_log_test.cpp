#include "host_sim/twins/recorded_log.h"

#include "tests/unit/host_sim/twins/log_file.h"

namespace vbar::twins::test {
namespace {

using fsw::GpsTime;
using RecordedLogFile = LogFile;

constexpr GpsTime kEpoch{995'000'000LL * 1'000'000'000LL};

GpsTime at(std::int64_t seconds) {
  return kEpoch + fsw::duration_of_seconds(seconds);
}

Packet navigation_packet(std::int64_t tag_s, std::uint8_t spacecraft, std::uint16_t count) {
  vbar::ideal_navigation message{};
  message.servicer_position_eci[0] = 7e6 + static_cast<double>(tag_s);
  return packet_of(message, at(tag_s), spacecraft, count);
}

TEST_F(RecordedLogFile, PlaysItsPacketsAtTheirRecordedDeliveries) {
  const Packet first = navigation_packet(0, 1, 0);
  const Packet late = navigation_packet(60, 1, 1);  // tagged 60 s, delivered with the step at 120 s
  const Packet in_time = navigation_packet(120, 1, 2);
  {
    PacketLogWriter writer(file_);
    writer.write({0, at(0), true, first});
    writer.write({0, at(0), true, packet_of(vbar::tick{}, at(0), 1, 0)});               // another message
    writer.write({0, at(0), true, navigation_packet(0, 2, 0)});                         // another spacecraft's
    writer.write({0, at(0), false, packet_of(vbar::telemetry_health{}, at(0), 1, 0)});  // from the flight software
    writer.write({2, at(120), true, late});
    writer.write({2, at(120), true, in_time});
  }
  RecordedLog source(file_, {1, fsw::packets::Apid::kIdealNavigation});
  EXPECT_EQ(source.next_epoch(at(-100)), at(0));
  EXPECT_EQ(source.next_epoch(at(0)), at(0));
  EXPECT_EQ(source.next_epoch(at(1)), at(120));
  EXPECT_FALSE(source.next_epoch(at(121)).has_value());

  const Measurement at_start = source.measure({at(0), {}});
  EXPECT_EQ(at_start.status, MeasurementStatus::kReady);
  EXPECT_TRUE(at_start.bypasses_link) << "the recorded link must not act twice";
  EXPECT_EQ(at_start.available, at(0));
  EXPECT_EQ(at_start.packets, std::vector<Packet>{first});
  EXPECT_TRUE(source.measure({at(60), {}}).packets.empty());
  EXPECT_EQ(source.measure({at(120), {}}).packets, (std::vector<Packet>{late, in_time}));
}

TEST_F(RecordedLogFile, LogWithoutThePacketsIsAnError) {
  {
    PacketLogWriter writer(file_);
    writer.write({0, at(0), true, packet_of(vbar::tick{}, at(0), 1, 0)});
  }
  try {
    const RecordedLog source(file_, {1, fsw::packets::Apid::kIdealNavigation});
    ADD_FAILURE() << "an empty source";
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(error.what(), file_.string() + ": contains no packet of the sensor to be replayed");
  }
  EXPECT_THROW(RecordedLog("no/such.lcmlog", {1, fsw::packets::Apid::kIdealNavigation}), std::runtime_error);
}

}  // namespace
}  // namespace vbar::twins::test
