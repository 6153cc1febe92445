#include "host_sim/twins/packet_log.h"

#include <limits>
#include <stdexcept>
#include <utility>

#include <vbar_host/packet_record.hpp>
#include <vbar_host/tile_run.hpp>

#include "fsw/packets/big_endian.h"
#include "fsw/packets/message_traits.h"
#include "fsw/packets/messages.h"
#include "host_sim/twins/lcm_log.h"

namespace vbar::twins {

namespace {

constexpr std::uint64_t kFnvOffset = 0xcbf29ce484222325U;
constexpr std::uint64_t kFnvPrime = 0x00000100000001b3U;

/// Adds a packet by its CRC, in which the packet ends.
std::uint64_t add_to_checksum(std::uint64_t checksum, const Packet& packet) {
  for (const std::uint8_t byte : std::span(packet).last(fsw::packets::kPacketCrcBytes))
    checksum = (checksum ^ byte) * kFnvPrime;
  return checksum;
}

}  // namespace

std::optional<TileRun> tile_run_of(const Packet& packet) {
  const auto view = fsw::packets::parse_packet(packet);
  if (!view.ok() || view.value().header.apid != fsw::packets::Apid::kImageTile) return std::nullopt;
  const auto tile = fsw::packets::decode<image_tile>(view.value());
  if (!tile.ok()) return std::nullopt;
  TileRun run;
  run.spacecraft = view.value().header.spacecraft;
  run.unit = view.value().header.unit;
  run.image = tile.value().image;
  run.first_tile = tile.value().tile;
  run.tiles = 1;
  run.checksum = add_to_checksum(kFnvOffset, packet);
  return run;
}

bool extend(TileRun& run, const TileRun& next, const Packet& packet) {
  const bool follows = next.spacecraft == run.spacecraft && next.unit == run.unit && next.image == run.image &&
                       next.first_tile == run.first_tile + run.tiles;
  if (!follows) return false;
  run.tiles = static_cast<std::int16_t>(run.tiles + 1);
  run.checksum = add_to_checksum(run.checksum, packet);
  return true;
}

std::uint64_t checksum_of(std::span<const Packet> packets) {
  std::uint64_t checksum = kFnvOffset;
  for (const Packet& packet : packets) checksum = add_to_checksum(checksum, packet);
  return checksum;
}

namespace {

// LCM counts microseconds since 1970; GPS time counts from 1980-01-06. Leap seconds are left out: it is a label, not a
// clock.
constexpr std::int64_t kGpsOriginInUnixMicroseconds = 315964800LL * 1000000;

template <class Message>
std::vector<std::uint8_t> bytes_of(const Message& message) {
  std::vector<std::uint8_t> data(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(data.data(), 0, static_cast<int>(data.size()));
  return data;
}

std::vector<std::uint8_t> encode_record(const PacketRecord& record) {
  vbar_host::packet_record message;
  message.step = record.step;
  message.gps_time_ns = record.time.ns;
  message.to_flight = record.to_flight ? 1 : 0;
  message.size = static_cast<std::int32_t>(record.packet.size());
  message.packet = record.packet;
  return bytes_of(message);
}

std::vector<std::uint8_t> encode_tiles(const PacketRecord& record) {
  vbar_host::tile_run message;
  message.step = record.step;
  message.gps_time_ns = record.time.ns;
  message.spacecraft = record.tiles->spacecraft;
  message.unit = record.tiles->unit;
  message.image = record.tiles->image;
  message.first_tile = record.tiles->first_tile;
  message.tiles = record.tiles->tiles;
  message.checksum = static_cast<std::int64_t>(record.tiles->checksum);
  return bytes_of(message);
}

[[noreturn]] void fail(const std::filesystem::path& file, const LoggedEvent& event, const std::string& what) {
  throw DamagedLog(file.string() + ": byte " + std::to_string(event.offset) + ": " + what);
}

// The size that a record claims, at its place in the encoded record, must be that of the event: the generated decoder
// allocates the claimed size before it checks that the bytes exist.
bool claims_its_size(const LoggedEvent& event) {
  constexpr std::size_t kSizeAt = 8 + 8 + 8 + 1;  // type hash, step, time, direction
  constexpr std::size_t kPacketAt = kSizeAt + 4;
  return event.data.size() >= kPacketAt &&
         fsw::packets::read_big_endian<std::uint32_t>(event.data, kSizeAt) == event.data.size() - kPacketAt;
}

/// True if the data are exactly one message of this type.
template <class Message>
bool decode_whole(const LoggedEvent& event, Message& message) {
  const auto size = static_cast<int>(event.data.size());
  return message.decode(event.data.data(), 0, size) == size;
}

bool is_step(std::int64_t number) {
  return number >= 0 && number <= std::numeric_limits<std::uint32_t>::max();
}

bool fits_header(std::int16_t number) {
  return number >= 0 && number <= std::numeric_limits<std::uint8_t>::max();
}

PacketRecord tiles_of(const LoggedEvent& event, const std::filesystem::path& file) {
  vbar_host::tile_run message;
  const bool good = decode_whole(event, message) && is_step(message.step) && fits_header(message.spacecraft) &&
                    fits_header(message.unit) && message.image >= 0 && message.first_tile >= 0 && message.tiles > 0;
  if (!good) fail(file, event, "a damaged record of image tiles");
  const TileRun run{static_cast<std::uint8_t>(message.spacecraft),
                    static_cast<std::uint8_t>(message.unit),
                    message.image,
                    message.first_tile,
                    message.tiles,
                    static_cast<std::uint64_t>(message.checksum)};
  return {static_cast<std::uint32_t>(message.step), {message.gps_time_ns}, true, {}, run};
}

PacketRecord packet_of(const LoggedEvent& event, const std::filesystem::path& file) {
  vbar_host::packet_record message;
  const bool good = claims_its_size(event) && decode_whole(event, message) && is_step(message.step) &&
                    (message.to_flight == 0 || message.to_flight == 1);
  if (!good) fail(file, event, "a damaged packet record");
  return {static_cast<std::uint32_t>(message.step),
          {message.gps_time_ns},
          message.to_flight == 1,
          std::move(message.packet)};
}

void take(LoggedEvent& event, const std::filesystem::path& file, PacketLog& log) {
  if (event.channel == kPacketChannel || event.channel == kTilesChannel) log.records.push_back(record_of(event, file));
  if (event.channel == kRecordingChannel) log.recordings.push_back({event.offset, std::move(event.data)});
  if (event.channel == kRecipeChannel) log.recipes.push_back(std::move(event.data));
  if (event.channel != kEndChannel) {
    ++log.events;
  } else if (event.data.size() == sizeof log.events) {
    log.events_at_end = fsw::packets::read_big_endian<std::uint64_t>(event.data, 0);
  } else {
    fail(file, event, "a damaged end record");
  }
}

}  // namespace

std::int64_t lcm_timestamp(fsw::GpsTime time) {
  return kGpsOriginInUnixMicroseconds + time.ns / 1000;
}

std::vector<LcmEvent> lcm_events_of(const PacketRecord& record) {
  std::vector<LcmEvent> events;
  if (record.tiles) {
    events.push_back({kTilesChannel, encode_tiles(record)});
    return events;
  }
  events.push_back({kPacketChannel, encode_record(record)});
  const auto view = fsw::packets::parse_packet(record.packet);
  if (!view.ok() || view.value().header.flags != fsw::packets::SequenceFlags::kUnsegmented) return events;
  const fsw::packets::PacketHeader& header = view.value().header;
  if (const char* name = fsw::packets::message_name(header.apid)) {
    const auto payload = view.value().payload;
    events.push_back(
        {"vbar/" + std::string(name) + "/" + std::to_string(header.spacecraft) + "/" + std::to_string(header.unit),
         {payload.begin(), payload.end()}});
  }
  return events;
}

PacketRecord record_of(const LoggedEvent& event, const std::filesystem::path& file) {
  return event.channel == kTilesChannel ? tiles_of(event, file) : packet_of(event, file);
}

PacketLogWriter::PacketLogWriter(const std::filesystem::path& file, EventCheck check)
    : log_(std::make_unique<LcmLogWriter>(file)), check_(std::move(check)) {}

PacketLogWriter::~PacketLogWriter() = default;

void PacketLogWriter::write(const PacketRecord& record) {
  for (LcmEvent& event : lcm_events_of(record)) check_and_write(record.time, std::move(event));
}

void PacketLogWriter::write_recipe(fsw::GpsTime time, std::vector<std::uint8_t> recipe) {
  check_and_write(time, {kRecipeChannel, std::move(recipe)});
}

// The flight software is to receive no image that is not in the file, on a full disk for instance.
void PacketLogWriter::write_recording(fsw::GpsTime time, std::vector<std::uint8_t> recording) {
  check_and_write(time, {kRecordingChannel, std::move(recording)});
  flush();
}

void PacketLogWriter::check_and_write(fsw::GpsTime time, LcmEvent event) {
  if (check_) check_(time, event);
  write_event(time, std::move(event));
}

void PacketLogWriter::write_event(fsw::GpsTime time, LcmEvent event) {
  log_->write(lcm_timestamp(time), event.channel, event.data);
  ++events_;
  last_ = time;
}

void PacketLogWriter::finish() {
  std::vector<std::uint8_t> count(sizeof events_);
  fsw::packets::write_big_endian(events_, std::span(count), 0);
  write_event(last_, {kEndChannel, std::move(count)});
  flush();
}

void PacketLogWriter::flush() {
  log_->flush();
}

PacketLog read_packet_log(const std::filesystem::path& file) {
  LcmLogReader reader(file);
  PacketLog log;
  log.file = file;
  std::int64_t before = -1;
  while (auto event = reader.next()) {
    // A damaged number may be the largest, which has no successor.
    const bool follows = static_cast<std::uint64_t>(event->number) == static_cast<std::uint64_t>(before) + 1U;
    if (!follows && !log.gap) log.gap = {event->offset, before, event->number};
    before = event->number;
    take(*event, file, log);
  }
  log.bytes = reader.size();
  log.cut_short = reader.cut_short();
  return log;
}

void ImageLogWriter::write_recipe(fsw::GpsTime time, const LoggedImage& recipe) {
  if (tiles_ == Tiles::kWhole) return;
  known_.insert(recipe.key);
  writer_.write_recipe(time, recipe.bytes);
}

void ImageLogWriter::write_recording(fsw::GpsTime time, const LoggedImage& recording) {
  if (tiles_ == Tiles::kAsRuns) known_.insert(recording.key);
  writer_.write_recording(time, recording.bytes);
}

void ImageLogWriter::write(const PacketRecord& record) {
  if (joins_run(record)) return;
  end_run();
  const auto tile = record.to_flight ? tile_run_of(record.packet) : std::nullopt;
  if (tile && known_.contains(tile->key())) {
    run_ = PacketRecord{record.step, record.time, true, {}, tile};
  } else {
    writer_.write(record);
  }
}

bool ImageLogWriter::joins_run(const PacketRecord& record) {
  if (!run_ || !record.to_flight) return false;
  const auto tile = tile_run_of(record.packet);
  return tile && extend(*run_->tiles, *tile, record.packet);
}

void ImageLogWriter::end_step() {
  end_run();
  writer_.flush();
}

void ImageLogWriter::end_run() {
  if (run_) writer_.write(*std::exchange(run_, std::nullopt));
}

}  // namespace vbar::twins
