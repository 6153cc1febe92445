#pragma once
// A recorded run as a sensor: the packets of a log, at the steps they were delivered in.

#include <filesystem>
#include <vector>

#include "fsw/packets/packet.h"
#include "host_sim/twins/packet_log.h"
#include "host_sim/twins/packet_source.h"

namespace vbar::twins {

class RecordedLog final : public PacketSource {
 public:
  /// Which packets of the log it plays, of those that went to the flight software.
  struct Selection {
    std::uint8_t spacecraft = 0;
    std::vector<fsw::packets::Apid> apids;
  };

  /// Throws std::runtime_error, as read_packet_log, and for a log without any such packet.
  RecordedLog(const std::filesystem::path& file, const Selection& selection);

  /// Time of the next recorded delivery.
  [[nodiscard]] std::optional<fsw::GpsTime> next_epoch(fsw::GpsTime from) const override;

  /// The packets delivered at the epoch, byte for byte and in the recorded order, past any simulated link. kReady with
  /// none if none were.
  Measurement measure(const TruthSnapshot& truth) override;

 private:
  struct Delivery {
    fsw::GpsTime time;
    Packet packet;
  };
  [[nodiscard]] std::vector<Delivery>::const_iterator first_at_or_after(fsw::GpsTime time) const;

  std::vector<Delivery> deliveries_;  ///< in order of time
};

}  // namespace vbar::twins
