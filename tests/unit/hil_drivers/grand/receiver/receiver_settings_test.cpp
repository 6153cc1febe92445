#include "hil_drivers/grand/bench/receiver/receiver_settings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host_sim/mission/mission_error.h"

namespace vbar::grand::bench::test {
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
}  // namespace vbar::grand::bench::test
