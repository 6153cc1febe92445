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
  RecordedLog source(file_, {1, {fsw::packets::Apid::kIdealNavigation}});
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

Packet tile_packet(std::int64_t exposure_s, std::uint8_t spacecraft, std::int16_t tile) {
  vbar::image_tile message{};
  message.tile = tile;
  return packet_of(message, at(exposure_s), spacecraft, static_cast<std::uint16_t>(tile));
}

TEST_F(RecordedLogFile, PlaysSeveralMessagesInTheOrderOfTheLog) {
  const Packet bytes = packet_of(vbar::gnss_bytes{}, at(0), 1, 0);
  const Packet attitude = packet_of(vbar::attitude{}, at(0), 1, 0);
  {
    PacketLogWriter writer(file_);
    writer.write({0, at(0), true, bytes});
    writer.write({0, at(0), true, navigation_packet(0, 1, 0)});
    writer.write({0, at(0), true, attitude});
  }
  RecordedLog source(file_, {1, {fsw::packets::Apid::kAttitude, fsw::packets::Apid::kGnssBytes}});
  EXPECT_EQ(source.measure({at(0), {}}).packets, (std::vector<Packet>{bytes, attitude}));
  EXPECT_FALSE(source.truth_is_compared());
}

// Images are judged by the truth at their exposures, which lie before their deliveries.
TEST_F(RecordedLogFile, ExposuresOfImagesAreEpochs) {
  const Packet tile = tile_packet(58, 1, 0);
  {
    PacketLogWriter writer(file_);
    writer.write({1, at(60), true, tile});
    writer.write({1, at(60), true, tile_packet(59, 2, 0)});  // another spacecraft's
  }
  RecordedLog source(file_, {1, {fsw::packets::Apid::kImageTile}});
  EXPECT_TRUE(source.truth_is_compared());
  EXPECT_EQ(source.next_epoch(at(0)), at(58));
  EXPECT_TRUE(source.measure({at(58), {}}).packets.empty());
  EXPECT_EQ(source.next_epoch(at(59)), at(60));
  EXPECT_EQ(source.measure({at(60), {}}).packets, std::vector<Packet>{tile});
}

/// Restores the same tiles for every run.
class FixedTiles final : public TileSource {
 public:
  explicit FixedTiles(ImagesOfLog&& images) : images_(std::move(images)) {}
  std::vector<Packet> packets_of(const TileRun& run) override {
    EXPECT_EQ(run, kRun);
    return tiles();
  }
  std::vector<GpsTime> exposures() const override { return {at(58)}; }
  std::optional<LoggedImage> recipe_at(GpsTime exposure) const override {
    return exposure == at(58) ? std::optional(LoggedImage{kRun.key(), images_.recipes.at(0)}) : std::nullopt;
  }
  std::optional<LoggedImage> recording_at(GpsTime exposure) const override {
    return exposure == at(58) ? std::optional(LoggedImage{kRun.key(), images_.recordings.at(0).bytes}) : std::nullopt;
  }

  static constexpr TileRun kRun{1, 0, 7, 0, 2, 99};
  static std::vector<Packet> tiles() { return {tile_packet(58, 1, 0), tile_packet(58, 1, 1)}; }

 private:
  ImagesOfLog images_;
};

TEST_F(RecordedLogFile, TilesThatTheLogLacksAreRestored) {
  {
    PacketLogWriter writer(file_);
    writer.write_recipe(at(58), {1, 2, 3});
    writer.write_recording(at(59), {4, 5});
    writer.write({1, at(60), true, {}, FixedTiles::kRun});
    writer.write({1, at(60), true, {}, TileRun{2, 0, 7, 0, 2, 99}});  // another spacecraft's
  }
  const MakeTileSource make = [&](ImagesOfLog&& images) {
    EXPECT_EQ(images.file, file_);
    return std::make_unique<FixedTiles>(std::move(images));
  };
  RecordedLog source(file_, {1, {fsw::packets::Apid::kImageTile}}, make);
  EXPECT_EQ(source.next_epoch(at(0)), at(58));
  const Measurement at_exposure = source.measure({at(58), {}});
  EXPECT_EQ(at_exposure.recipe, (LoggedImage{{1, 0, 7}, {1, 2, 3}}));
  EXPECT_EQ(at_exposure.recording, (LoggedImage{{1, 0, 7}, {4, 5}}));
  EXPECT_EQ(source.measure({at(60), {}}).packets, FixedTiles::tiles());
  EXPECT_THROW(RecordedLog(file_, {1, {fsw::packets::Apid::kImageTile}}), std::runtime_error);
}

TEST_F(RecordedLogFile, LogWithoutThePacketsIsAnError) {
  {
    PacketLogWriter writer(file_);
    writer.write({0, at(0), true, packet_of(vbar::tick{}, at(0), 1, 0)});
  }
  try {
    const RecordedLog source(file_, {1, {fsw::packets::Apid::kIdealNavigation}});
    ADD_FAILURE() << "an empty source";
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(error.what(), file_.string() + ": contains no packet of the sensor to be replayed");
  }
  EXPECT_THROW(RecordedLog("no/such.lcmlog", {1, {fsw::packets::Apid::kIdealNavigation}}), std::runtime_error);
}

}  // namespace
}  // namespace vbar::twins::test
