#pragma once
// A recorded run as a sensor: the packets of a log, at the steps of their delivery.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "fsw/packets/packet.h"
#include "host_sim/twins/packet_log.h"
#include "host_sim/twins/packet_source.h"

namespace vbar::twins {

class RecordedLog final : public PacketSource {
 public:
  /// Packets of the log to replay, among those sent to the flight software.
  struct Selection {
    std::uint8_t spacecraft = 0;
    std::vector<fsw::packets::Apid> apids;
    std::optional<std::uint8_t> unit = {};  ///< none: packets of all units
  };

  /// Opens a log. `make_tiles` is needed for logs without the pixels of their images. Throws std::runtime_error, as
  /// read_packet_log, for a log without any such packet, and for one that lacks tiles without `make_tiles`.
  RecordedLog(const std::filesystem::path& file, const Selection& selection, const MakeTileSource& make_tiles = {});

  /// Returns the time of the next recorded delivery, or of the next exposure of a recorded image: its truth is then
  /// recorded.
  [[nodiscard]] std::optional<fsw::GpsTime> next_epoch(fsw::GpsTime from) const override;

  /// Returns the packets delivered at the epoch, byte for byte and in the recorded order, past any simulated link.
  /// kReady with none if none were. At an exposure also its recipe and its recording, for the log of this run. Throws
  /// as TileSource.
  Measurement measure(const TruthSnapshot& truth) override;

  /// True for the log of a camera.
  [[nodiscard]] bool truth_is_compared() const override { return plays_images_; }

 private:
  struct Delivery {
    fsw::GpsTime time;
    Packet packet;
    std::optional<TileRun> tiles;  ///< in the place of the packet
  };
  void add(PacketRecord&& record, const Selection& selection);
  [[nodiscard]] std::vector<Delivery>::const_iterator first_at_or_after(fsw::GpsTime time) const;

  std::vector<Delivery> deliveries_;   ///< in order of time
  std::set<fsw::GpsTime> epochs_;      ///< epochs of deliveries and exposures
  std::unique_ptr<TileSource> tiles_;  ///< null: the log holds all tiles
  bool plays_images_ = false;
};

}  // namespace vbar::twins
