#pragma once
// From the bytes of the receivers to observation epochs, in order of their tags, and broadcast ephemerides: shared by
// the sources that use them.

#include <array>
#include <cstdint>
#include <optional>

#include "fsw/navigation/ephemeris_store.h"
#include "fsw/navigation/epoch_buffer.h"
#include "fsw/sources/gnss/receiver_decoders.h"

namespace vbar::fsw::sources {

class GnssFrontEnd {
 public:
  /// When a receiver was heard.
  struct Heard {
    GpsTime newest;        ///< tag of its newest epoch
    Duration interval{0};  ///< from the epoch before it; 0 of the first
  };
  /// Decodes the packets of the step. An epoch tagged before `oldest`, or twice, is counted as too late.
  void decode(gnc::Inbox& inbox, GpsTime oldest);

  [[nodiscard]] const navigation::EphemerisStore& ephemerides() const { return ephemerides_; }
  [[nodiscard]] const navigation::EpochBuffer& waiting(Receiver receiver) const {
    return waiting_[static_cast<std::size_t>(receiver)];
  }
  /// An epoch of a receiver was received.
  void hear(Receiver receiver, GpsTime tag);
  /// Empty before the first epoch of the receiver.
  [[nodiscard]] const std::optional<Heard>& heard(Receiver receiver) const {
    return heard_[static_cast<std::size_t>(receiver)];
  }
  /// Epochs of both receivers tagged before `time` are no longer needed.
  void drop_before(GpsTime time) {
    for (navigation::EpochBuffer& buffer : waiting_) buffer.drop_through(time - Duration{1});
  }

  /// Clock of the servicer's receiver (c times its advance, m) by the single-point solution of an epoch.
  void keep_servicer_clock(GpsTime tag, double clock_m) { servicer_clock_ = {tag, clock_m}; }
  /// No value if the epoch of that tag had no solution.
  [[nodiscard]] std::optional<double> servicer_clock_m(GpsTime tag) const {
    return servicer_clock_.tag == tag ? std::optional(servicer_clock_.clock_m) : std::nullopt;
  }
  [[nodiscard]] std::int32_t too_late() const { return too_late_; }
  /// Complete messages of both receivers, and those refused because of checksum or contents.
  [[nodiscard]] std::int32_t messages() const { return decoders_.messages(); }
  [[nodiscard]] std::int32_t messages_refused() const { return decoders_.refused(); }

 private:
  struct ServicerClock {
    GpsTime tag{-1};
    double clock_m = 0.0;
  };

  ReceiverDecoders decoders_;
  navigation::EphemerisStore ephemerides_;
  std::array<navigation::EpochBuffer, 2> waiting_{};
  std::array<std::optional<Heard>, 2> heard_{};
  ServicerClock servicer_clock_;
  std::int32_t too_late_ = 0;
};

}  // namespace vbar::fsw::sources
