#pragma once
// A source whose packets are lost, repeated or wrong while a fault is present. Before its first fault it is
// transparent.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/faults/fault_schedule.h"
#include "host_sim/twins/packet_source.h"

namespace vbar::faults {

class FaultySource final : public twins::PacketSource {
 public:
  /// `name`: of the source, "servicer/camera"; its faults are those of this unit of this spacecraft.
  FaultySource(std::unique_ptr<twins::PacketSource> source, std::shared_ptr<const FaultSchedule> schedule,
               std::string name);

  void start(fsw::GpsTime first_epoch) override { source_->start(first_epoch); }
  void stop(twins::StopReason reason) override { source_->stop(reason); }
  [[nodiscard]] std::optional<fsw::GpsTime> next_epoch(fsw::GpsTime from) const override {
    return source_->next_epoch(from);
  }
  twins::Measurement measure(const twins::TruthSnapshot& truth) override;
  void command(const fsw::packets::PacketView& packet, fsw::GpsTime effective) override {
    source_->command(packet, effective);
  }
  bool upset(const twins::Upset& upset) override { return source_->upset(upset); }
  [[nodiscard]] twins::TruthDetail truth_detail() const override { return source_->truth_detail(); }
  [[nodiscard]] std::optional<io::WiredReceiver> wired_receiver() const override { return source_->wired_receiver(); }
  [[nodiscard]] bool truth_is_compared() const override { return source_->truth_is_compared(); }
  [[nodiscard]] std::chrono::milliseconds wait_limit() const override { return source_->wait_limit(); }
  [[nodiscard]] std::vector<twins::Note> statistics() const override { return source_->statistics(); }

 private:
  /// The truth as this source sees it.
  [[nodiscard]] twins::TruthSnapshot seen(const twins::TruthSnapshot& truth) const;

  /// Applies the faults of the device whose instants have come since the last measurement.
  void upset_device(fsw::GpsTime time);

  /// The tiles of an image, shared with measurements that are pending.
  struct LastImage;

  std::unique_ptr<twins::PacketSource> source_;
  std::shared_ptr<const FaultSchedule> schedule_;
  std::vector<const mission::Fault*> faults_;  ///< faults of the schedule that concern this source
  std::vector<bool> is_upset_;                 ///< by each of them already
  std::shared_ptr<LastImage> last_image_;
};

/// Whether the fault is one of the source of this name.
[[nodiscard]] bool is_of_source(const mission::Fault& fault, std::string_view source);

/// The attitude packet with its attitude turned by `angle` (rad) about the body's x axis; other packets as they are.
[[nodiscard]] twins::Packet with_attitude_error(const twins::Packet& packet, double angle);

/// The tiles of `now` with the pixels of `last`, tile by tile; packets that are no tiles as they are.
[[nodiscard]] std::vector<twins::Packet> with_pixels_of(const std::vector<twins::Packet>& last,
                                                        std::vector<twins::Packet> now);

}  // namespace vbar::faults
