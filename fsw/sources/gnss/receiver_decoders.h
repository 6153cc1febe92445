#pragma once
// The decoders of both receivers' bytes.

#include <array>
#include <cstdint>

#include "fsw/gnc/inbox.h"
#include "fsw/gnss/receiver_decoder.h"

namespace vbar::fsw::sources {

enum class Receiver : std::uint8_t { kServicer = 0, kTarget = 1 };

class ReceiverDecoders {
 public:
  /// Passes what the packets of the step complete to `on_epoch(receiver, epoch)` and `on_ephemeris(ephemeris)`. A
  /// packet with a count beyond its array is counted in the inbox and skipped.
  template <class OnEpoch, class OnEphemeris>
  void decode(gnc::Inbox& inbox, OnEpoch&& on_epoch, OnEphemeris&& on_ephemeris) {
    decode_one(Receiver::kServicer, inbox.queue<vbar::gnss_bytes>(), inbox, on_epoch, on_ephemeris);
    decode_one(Receiver::kTarget, inbox.queue<vbar::crosslink_gnss_bytes>(), inbox, on_epoch, on_ephemeris);
  }

  /// Complete messages of both receivers, and those refused because of checksum or contents.
  [[nodiscard]] std::int32_t messages() const;
  [[nodiscard]] std::int32_t refused() const;

 private:
  template <class Queue, class OnEpoch, class OnEphemeris>
  void decode_one(Receiver receiver, const Queue& packets, gnc::Inbox& inbox, OnEpoch& on_epoch,
                  OnEphemeris& on_ephemeris) {
    gnss::ReceiverDecoder& decoder = decoders_[static_cast<std::size_t>(receiver)];
    for (std::size_t k = 0; k < packets.size(); ++k) {
      const auto& message = packets[k].value;
      if (message.count < 0 || message.count > static_cast<std::int32_t>(sizeof message.data)) {
        inbox.count_bad_content();
        continue;
      }
      for (std::int32_t n = 0; n < message.count; ++n) {
        switch (decoder.push(message.data[n])) {
          case gnss::ReceiverUpdate::kObservations:
            on_epoch(receiver, decoder.observations());
            break;
          case gnss::ReceiverUpdate::kEphemeris:
            on_ephemeris(decoder.ephemeris());
            break;
          case gnss::ReceiverUpdate::kNone:
          case gnss::ReceiverUpdate::kIonosphere:
          case gnss::ReceiverUpdate::kClock:
          case gnss::ReceiverUpdate::kPosition:
            break;
        }
      }
    }
  }

  std::array<gnss::ReceiverDecoder, 2> decoders_{};
};

}  // namespace vbar::fsw::sources
