#pragma once
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

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "fsw/core/gps_time.h"
#include "host_sim/twins/packet_source.h"
#include "host_sim/twins/tile_run.h"

namespace vbar::twins {

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

}  // namespace vbar::twins
