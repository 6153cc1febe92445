#include "host_sim/twins/packet_log.h"

#include <gmock/gmock.h>

#include "host_sim/twins/recorded_log.h"
#include "tests/unit/host_sim/twins/log_file.h"

namespace vbar::twins::test {

namespace {

using fsw::GpsTime;

using PacketLogFile = LogFile;

// 2011-07-18 01:00:15 GPS, the mission's epoch.
constexpr GpsTime kEpoch{995'000'000LL * 1'000'000'000LL};

std::vector<PacketRecord> some_records() {
  std::vector<PacketRecord> records;
  for (std::uint32_t step = 0; step < 3; ++step) {
    const GpsTime time = kEpoch + fsw::duration_of_seconds(60 * step);
    vbar::tick tick{};
    tick.step = step;
    records.push_back({step, time, true, packet_of(tick, time, 1, static_cast<std::uint16_t>(step))});
    vbar::telemetry_health health{};
    health.step = step;
    records.push_back({step, time, false, packet_of(health, time, 1, static_cast<std::uint16_t>(step))});
  }
  records.push_back({3, kEpoch + fsw::duration_of_seconds(180), true, {0xDE, 0xAD, 0x00, 0xBE}});  // no packet at all
  records.push_back({3, kEpoch + fsw::duration_of_seconds(180), true, {}});
  return records;
}

void write(const std::filesystem::path& file, const std::vector<PacketRecord>& records) {
  PacketLogWriter writer(file);
  for (const PacketRecord& record : records) writer.write(record);
}

TEST_F(PacketLogFile, GivesBackEveryByteInOrder) {
  const std::vector<PacketRecord> records = some_records();
  write(file_, records);
  const PacketLog log = read_packet_log(file_);
  EXPECT_FALSE(log.cut_short);
  ASSERT_EQ(log.records.size(), records.size());
  for (std::size_t k = 0; k < records.size(); ++k) {
    EXPECT_EQ(log.records[k].step, records[k].step);
    EXPECT_EQ(log.records[k].time, records[k].time);
    EXPECT_EQ(log.records[k].to_flight, records[k].to_flight);
    EXPECT_EQ(log.records[k].packet, records[k].packet);
  }
}

TEST_F(PacketLogFile, SameRunMakesTheSameFile) {
  write(file_, some_records());
  const std::string first = content();
  write(file_, some_records());
  EXPECT_EQ(content(), first);
  EXPECT_FALSE(first.empty());
}

// The layout of LCM's log format, read byte by byte: sync word, event number, microseconds, channel and data lengths,
// all big-endian; then a record whose packet stands at its end.
TEST_F(PacketLogFile, IsInLcmsLogFormat) {
  const std::vector<PacketRecord> records = some_records();
  write(file_, {records[0]});
  const std::string bytes = content();
  const auto number = [&](std::size_t at, std::size_t size) {
    std::uint64_t value = 0;
    for (std::size_t k = 0; k < size; ++k) value = value << 8U | static_cast<std::uint8_t>(bytes.at(at + k));
    return value;
  };
  EXPECT_EQ(number(0, 4), 0xEDA1DA01U);
  EXPECT_EQ(number(4, 8), 0U);
  EXPECT_EQ(number(12, 8), (995000000U + 315964800U) * std::uint64_t{1000000});
  EXPECT_EQ(number(20, 4), 11U);
  const std::size_t packet_size = records[0].packet.size();
  EXPECT_EQ(number(24, 4), 8 + 8 + 8 + 1 + 4 + packet_size) << "type hash, step, time, direction, size, packet";
  EXPECT_EQ(bytes.substr(28, 11), "VBAR_PACKET");
  EXPECT_EQ(bytes.substr(39 + 29, packet_size), std::string(records[0].packet.begin(), records[0].packet.end()));
  // The second event is the message alone, as any LCM program understands it.
  const std::size_t second = 39 + 29 + packet_size;
  EXPECT_EQ(number(second, 4), 0xEDA1DA01U);
  EXPECT_EQ(bytes.substr(second + 28, 13), "vbar/tick/1/0");
}

TEST_F(PacketLogFile, ListenersGetTheMessageOfEveryWholePacket) {
  vbar::tick tick{};
  tick.step = 5;
  tick.period_ns = 60;
  const auto events = lcm_events_of({5, kEpoch, true, packet_of(tick, kEpoch, 2, 0)});
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events[0].channel, "VBAR_PACKET");
  EXPECT_EQ(events[1].channel, "vbar/tick/2/0");
  // Type hash, step, period: what lcm-gen's own encoder would make, here from LCM's rule that fields are big-endian.
  ASSERT_EQ(events[1].data.size(), 24U);
  EXPECT_EQ(events[1].data[15], 5);
  EXPECT_EQ(events[1].data[23], 60);
  EXPECT_EQ(lcm_events_of({5, kEpoch, true, {1, 2, 3}}).size(), 1U) << "a broken packet is recorded and not announced";
}

TEST_F(PacketLogFile, OtherEventsArePassedOver) {
  write(file_, {some_records()[0]});
  const std::string bytes = content();
  std::string foreign = bytes;
  foreign.replace(foreign.find("VBAR_PACKET"), 11, "LCM_SELFTES");
  std::ofstream(file_, std::ios::binary) << foreign << bytes;
  EXPECT_EQ(read_packet_log(file_).records.size(), 1U);
}

TEST_F(PacketLogFile, CutAtAnyByteItGivesTheWholeEventsBefore) {
  const std::vector<PacketRecord> records = some_records();
  write(file_, records);
  const std::string bytes = content();
  std::size_t last_count = 0;
  for (std::size_t size = 0; size < bytes.size(); size += 7) {
    std::ofstream(file_, std::ios::binary | std::ios::trunc) << bytes.substr(0, size);
    if (size > 0 && size < 4) continue;  // not even the sync word: refused as no log
    const PacketLog log = read_packet_log(file_);
    EXPECT_GE(log.records.size(), last_count);
    last_count = log.records.size();
    for (std::size_t k = 0; k < log.records.size(); ++k) EXPECT_EQ(log.records[k].packet, records[k].packet);
  }
  std::ofstream(file_, std::ios::binary | std::ios::trunc) << bytes.substr(0, bytes.size() - 1);
  EXPECT_TRUE(read_packet_log(file_).cut_short);
}

std::string error_of(const std::filesystem::path& file) {
  try {
    static_cast<void>(read_packet_log(file));
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return {};
}

TEST_F(PacketLogFile, BadFilesAreNamed) {
  EXPECT_EQ(error_of(file_), file_.string() + ": no such file");
  std::ofstream(file_) << "[mission]\n";
  EXPECT_EQ(error_of(file_), file_.string() + ": byte 0: not an LCM log");
  write(file_, {some_records()[0]});
  std::string bytes = content();
  bytes[39] = static_cast<char>(bytes[39] ^ 1);  // first byte of the record: its type hash
  std::ofstream(file_, std::ios::binary) << bytes;
  EXPECT_EQ(error_of(file_), file_.string() + ": byte 0: a damaged packet record");
  EXPECT_THROW(PacketLogWriter("/no/such/folder/x.lcmlog"), std::runtime_error);
}

// A record that claims more bytes than its event has must be refused, not read past the end.
TEST_F(PacketLogFile, RecordThatClaimsTooManyBytesIsRefused) {
  write(file_, {some_records()[0]});
  std::string bytes = content();
  for (const int claimed : {0x7F, 0xFF}) {  // enormous and negative
    bytes[39 + 25] = static_cast<char>(claimed);
    std::ofstream(file_, std::ios::binary) << bytes;
    EXPECT_EQ(error_of(file_), file_.string() + ": byte 0: a damaged packet record");
  }
}

TEST_F(PacketLogFile, StatesItsEndAndWhatIsMissing) {
  {
    PacketLogWriter writer(file_);
    for (const PacketRecord& record : some_records()) writer.write(record);
    writer.finish();
  }
  const std::string bytes = content();
  const PacketLog whole = read_packet_log(file_);
  EXPECT_EQ(whole.events_at_end, whole.events);
  EXPECT_FALSE(whole.gap);
  EXPECT_EQ(whole.bytes, bytes.size());
  // Without its first event: the numbers start at 1.
  const std::size_t second = bytes.find("\xED\xA1\xDA\x01", 4);
  std::ofstream(file_, std::ios::binary | std::ios::trunc) << bytes.substr(second);
  const PacketLog thinned = read_packet_log(file_);
  ASSERT_TRUE(thinned.gap);
  EXPECT_EQ(thinned.gap->before, -1);
  EXPECT_EQ(thinned.gap->after, 1);
}

// Sizes in the header, by LCM's format at bytes 20 (channel) and 24 (data). LCM's own reader crashes on the first.
TEST_F(PacketLogFile, SizesThatCannotBeAreRefusedWithTheirPlace) {
  write(file_, some_records());
  const std::string bytes = content();
  const std::size_t second = bytes.find("\xED\xA1\xDA\x01", 4);
  for (const std::size_t field : {20U, 24U}) {
    for (const char* size : {"\x7F\xFF\xFF\xFF", "\xFF\xFF\xFF\xFF", "\x01\x00\x00\x00", "\x00\x00\x10\x00"}) {
      std::string damaged = bytes;
      damaged.replace(second + field, 4, std::string(size, 4));
      std::ofstream(file_, std::ios::binary | std::ios::trunc) << damaged;
      EXPECT_THAT(error_of(file_), testing::StartsWith(file_.string() + ": byte " + std::to_string(second) + ": "));
    }
  }
}

}  // namespace

namespace {

using RecordedLogFile = LogFile;

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
