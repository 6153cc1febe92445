#pragma once
// A GNSS receiver and a star tracker as a packet source: at each epoch the receiver's bytes and the attitude, straight
// to the flight software, or by way of the crosslink if they are those of another spacecraft. The receiver is
// a twin or a device (gnss/receiver_bytes.h).

#include <memory>
#include <optional>
#include <string>

#include "fsw/core/gps_time.h"
#include "host_sim/twins/gnss/crosslink.h"
#include "host_sim/twins/gnss/receiver_bytes.h"
#include "host_sim/twins/packet_encoder.h"
#include "host_sim/twins/packet_source.h"

namespace vbar::twins {

class GnssSensor final : public PacketSource {
 public:
  struct Settings {
    std::string spacecraft;          ///< that carries the receiver
    std::uint8_t flight_number = 0;  ///< number of the spacecraft whose flight software receives the packets
    fsw::GpsTime start;              ///< first epoch
    fsw::Duration period;            ///< > 0, integer milliseconds: between calls of the receiver
    fsw::GpsTime delivers_from{};    ///< the data of earlier epochs are not sent
  };

  /// Makes a sensor. `crosslink`: how the bytes reach the flight software; null: by wire. `receiver` must not be null.
  GnssSensor(const Settings& settings, std::unique_ptr<gnss::ReceiverBytes> receiver,
             std::unique_ptr<gnss::Crosslink> crosslink);

  void start(fsw::GpsTime first_epoch) override { receiver_->start(first_epoch); }
  void stop(StopReason reason) override { receiver_->stop(reason); }
  [[nodiscard]] TruthDetail truth_detail() const override { return receiver_->truth_detail(); }
  [[nodiscard]] std::vector<Note> statistics() const override { return receiver_->statistics(); }

  [[nodiscard]] std::optional<io::WiredReceiver> wired_receiver() const override { return receiver_->wired_receiver(); }
  bool upset(const Upset& upset) override { return receiver_->upset(upset); }

  [[nodiscard]] std::optional<fsw::GpsTime> next_epoch(fsw::GpsTime from) const override;

  /// Measures the packets of one epoch: receiver bytes in pieces, and the attitude. No packets if the crosslink loses
  /// them, which applies to all of them. kFailed if the truth lacks the spacecraft or its attitude, or the receiver
  /// fails.
  Measurement measure(const TruthSnapshot& truth) override;

  [[nodiscard]] const gnss::ReceiverBytes& receiver() const { return *receiver_; }

 private:
  template <class BytesMessage, class AttitudeMessage>
  bool append_packets(fsw::GpsTime arrival, const gnss::ReceiverOutput& output, const gnss::EpochAttitude& measured,
                      std::vector<Packet>& packets);

  Settings settings_;
  std::unique_ptr<gnss::ReceiverBytes> receiver_;
  std::unique_ptr<gnss::Crosslink> crosslink_;
  PacketEncoder bytes_encoder_;
  PacketEncoder attitude_encoder_;
};

}  // namespace vbar::twins
