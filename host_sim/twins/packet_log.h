#pragma once
// Image tiles that a log holds without their pixels.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "fsw/core/gps_time.h"
#include "host_sim/twins/packet_source.h"

namespace vbar::twins {

/// Consecutive tiles of one image, in order.
struct TileRun {
  std::uint8_t spacecraft = 0;  ///< as in the packets' headers
  std::uint8_t unit = 0;
  std::int32_t image = 0;
  std::int16_t first_tile = 0;
  std::int16_t tiles = 0;
  std::uint64_t checksum = 0;  ///< FNV-1a, 64 bits, of the packets' own CRCs, one after another
  [[nodiscard]] ImageKey key() const { return {spacecraft, unit, image}; }
  friend bool operator==(const TileRun&, const TileRun&) = default;
};

/// Returns the run of this packet alone; empty if it is not an image tile.
[[nodiscard]] std::optional<TileRun> tile_run_of(const Packet& packet);

/// Appends the run of the next tile; false, without a change, if it is not the next one. `packet` is the tile.
bool extend(TileRun& run, const TileRun& next, const Packet& packet);

/// Returns the checksum of a run of these packets, each a whole space packet.
[[nodiscard]] std::uint64_t checksum_of(std::span<const Packet> packets);

// Logs of packets in LCM's log format: the log of a run (packets.lcmlog), and the log that lcm-logger writes when it
// listens to a live run. A packet is two events:
//   VBAR_PACKET                               a vbar_host.packet_record: the whole space packet, its step and direction
//   vbar/<message>/<spacecraft>/<unit>        the LCM message inside it, for lcm-spy and other LCM programs that only
//   listen
// Images of a camera may be replaced by
//   VBAR_IMAGE_RECIPE                         a vbar_host.image_recipe: from which a digital image can be regenerated
//   VBAR_IMAGE                                a vbar_host.recorded_image: the pixels of an image of a testbed
//   VBAR_IMAGE_TILES                          a vbar_host.tile_run: in place of some of the tiles of either
// The last event of a run that ended is
//   VBAR_END                                  the number of events before it, 8 bytes big-endian
// Only the channels in capitals are read back. Event times are the simulated GPS time, so that the same run writes the
// same log.

inline constexpr const char* kPacketChannel = "VBAR_PACKET";
inline constexpr const char* kRecipeChannel = "VBAR_IMAGE_RECIPE";
inline constexpr const char* kRecordingChannel = "VBAR_IMAGE";
inline constexpr const char* kTilesChannel = "VBAR_IMAGE_TILES";
inline constexpr const char* kEndChannel = "VBAR_END";

/// A packet at the interface of a flight computer.
struct PacketRecord {
  std::uint32_t step = 0;  ///< number of the flight step that received it (its inputs and its tick) or sent it
  fsw::GpsTime time;       ///< time of that step
  bool to_flight = false;
  Packet packet;
  /// Packets that are not in the log, in place of `packet`, which is empty then.
  std::optional<TileRun> tiles = std::nullopt;
};

/// LCM messages of a packet.
struct LcmEvent {
  std::string channel;
  std::vector<std::uint8_t> data;
};

/// Returns the record and, if the packet is whole and holds an LCM message, the message.
[[nodiscard]] std::vector<LcmEvent> lcm_events_of(const PacketRecord& record);

/// Receives every event of a new log except its end, before it is written. If it throws, the event is left out.
using EventCheck = std::function<void(fsw::GpsTime time, const LcmEvent& event)>;

/// Returns an event's time in the log, us: that of LCM.
[[nodiscard]] std::int64_t lcm_timestamp(fsw::GpsTime time);

class LcmLogWriter;

class PacketLogWriter {
 public:
  /// Creates or truncates `file`. Throws std::runtime_error that names it. `check` may be empty.
  explicit PacketLogWriter(const std::filesystem::path& file, EventCheck check = {});
  ~PacketLogWriter();
  PacketLogWriter(const PacketLogWriter&) = delete;
  PacketLogWriter& operator=(const PacketLogWriter&) = delete;

  /// Throws std::runtime_error if the file cannot be written.
  void write(const PacketRecord& record);
  /// Writes a recipe (Measurement::recipe) of this time. Throws as write().
  void write_recipe(fsw::GpsTime time, std::vector<std::uint8_t> recipe);
  /// Writes a recording (Measurement::recording) of this time, which is in the file when the function returns. Throws
  /// as write().
  void write_recording(fsw::GpsTime time, std::vector<std::uint8_t> recording);

  /// Hands all that was written to the operating system: it outlives the program. Throws as write.
  void flush();

  /// Marks the end of the run; everything written is in the file then. Throws as write.
  void finish();

 private:
  void check_and_write(fsw::GpsTime time, LcmEvent event);
  void write_event(fsw::GpsTime time, LcmEvent event);

  std::unique_ptr<LcmLogWriter> log_;
  EventCheck check_;
  std::uint64_t events_ = 0;
  fsw::GpsTime last_;
};

struct LoggedEvent;

/// Returns the record that an event of kPacketChannel or kTilesChannel holds. Throws DamagedLog, which names `file`.
[[nodiscard]] PacketRecord record_of(const LoggedEvent& event, const std::filesystem::path& file);

/// Two consecutive events whose numbers are not consecutive: events between them were removed.
/// The first event is preceded by event -1.
struct EventGap {
  std::uint64_t offset = 0;  ///< offset of the second event in the file
  std::int64_t before = 0, after = 0;
};

/// Data that a log holds in place of image tiles, in the order of the file and as encoded.
struct ImagesOfLog {
  struct Recording {
    std::uint64_t offset = 0;  ///< offset of the event in the file
    std::vector<std::uint8_t> bytes;
  };
  std::filesystem::path file;
  std::vector<std::vector<std::uint8_t>> recipes;
  std::vector<Recording> recordings;
};

struct PacketLog : ImagesOfLog {
  std::vector<PacketRecord> records;           ///< in the order of the file
  std::uint64_t bytes = 0;                     ///< size of the file
  bool cut_short = false;                      ///< the file ends within an event, as that of a killed run may
  std::optional<EventGap> gap;                 ///< the first one
  std::uint64_t events = 0;                    ///< number of events of all channels, the end excepted
  std::optional<std::uint64_t> events_at_end;  ///< as VBAR_END states; none if the log has no end
};

/// Reads all packets of a log; events of other channels are ignored. Throws std::runtime_error that names a file
/// that cannot be read, and DamagedLog (lcm_log.h) for one that is not an LCM log or holds a damaged record.
[[nodiscard]] PacketLog read_packet_log(const std::filesystem::path& file);

// The log of a run without the tiles of its images: it holds what they can be made from, and runs of tiles in place of
// the tiles that went to the flight software. The tiles of an image are 600 kB, its recipe and its runs 2 kB, its
// recording some 120 kB.

/// Writes such a log. Tiles of images of which it was given neither recipe nor recording stay whole.
class ImageLogWriter {
 public:
  /// Form of a tile in the log.
  enum class Tiles {
    kAsRuns,
    kWhole,  ///< nothing: recipes are not kept; recordings are, so that an image is in the log before it is used
  };

  /// Creates the log as PacketLogWriter does.
  ImageLogWriter(const std::filesystem::path& file, Tiles tiles, EventCheck check = {})
      : writer_(file, std::move(check)), tiles_(tiles) {}

  /// Writes a recipe, before the tiles of its image.
  void write_recipe(fsw::GpsTime time, const LoggedImage& recipe);
  /// Writes a recording, before the tiles of its image. It is in the file when the function returns.
  void write_recording(fsw::GpsTime time, const LoggedImage& recording);

  /// Writes a packet; packets come in order. A tile may be held back until it is known how far its run goes.
  void write(const PacketRecord& record);

  /// Ends a step; called at the end of every step, because a run of tiles does not reach beyond one. It writes what was
  /// held back. All that was written outlives the program then. Throws as PacketLogWriter.
  void end_step();

  /// Ends the log as PacketLogWriter does.
  void finish() { writer_.finish(); }

 private:
  bool joins_run(const PacketRecord& record);
  void end_run();

  PacketLogWriter writer_;
  Tiles tiles_;
  std::set<ImageKey> known_;
  std::optional<PacketRecord> run_;
};

// Image tiles that a log holds in another form.

/// Restores the tiles. A camera provides it (camera/logged_image.h).
class TileSource {
 public:
  TileSource() = default;
  TileSource(const TileSource&) = delete;
  TileSource& operator=(const TileSource&) = delete;
  virtual ~TileSource() = default;

  /// Returns the packets of a run. Throws DamagedLog for a damaged recording and std::runtime_error for a run that
  /// cannot be restored; the message names file and image.
  virtual std::vector<Packet> packets_of(const TileRun& run) = 0;

  /// Returns the times of all exposures of which the log holds recipe or recording.
  [[nodiscard]] virtual std::vector<fsw::GpsTime> exposures() const = 0;
  /// Return what the log holds of the exposure.
  [[nodiscard]] virtual std::optional<LoggedImage> recipe_at(fsw::GpsTime exposure) const = 0;
  [[nodiscard]] virtual std::optional<LoggedImage> recording_at(fsw::GpsTime exposure) const = 0;
};

/// Makes a TileSource from the images of a log. Throws DamagedLog.
using MakeTileSource = std::function<std::unique_ptr<TileSource>(ImagesOfLog&&)>;

}  // namespace vbar::twins
