#pragma once
// Conversion of the bytes of one receiver to observations and ephemerides: the stream, its messages, their contents.

#include <array>
#include <cstdint>

#include "fsw/core/result.h"
#include "fsw/gnss/ephemeris.h"
#include "fsw/gnss/observation.h"
#include "fsw/gnss/oem_range.h"
#include "fsw/gnss/oem_solution.h"
#include "fsw/gnss/oem_stream.h"
#include "fsw/messaging/inbox.h"

namespace vbar::fsw::gnss {

/// Result of a byte.
enum class ReceiverUpdate : std::uint8_t {
  kNone = 0,
  kObservations,
  kEphemeris,
  kIonosphere,
  kClock,
  kPosition,
};

struct ReceiverCounters {
  std::uint32_t unknown = 0;    ///< complete messages that are not decoded here, responses and other antennas included
  std::uint32_t not_ready = 0;  ///< messages in which the receiver reports no valid data yet
  std::uint32_t refused = 0;    ///< messages with invalid contents
  ObservationTally observations;
};

/// Decodes the bytes of one receiver. The complete state is plain data, so that a copy continues as the original does.
class ReceiverDecoder {
 public:
  /// Processes one byte. The data reported as updated can be read until the next push.
  [[nodiscard]] ReceiverUpdate push(std::uint8_t byte);

  [[nodiscard]] const ObservationEpoch& observations() const { return observations_; }
  [[nodiscard]] const Ephemeris& ephemeris() const { return ephemeris_; }
  [[nodiscard]] const KlobucharCoefficients& ionosphere() const { return ionosphere_; }
  [[nodiscard]] const ReceiverClock& receiver_clock() const { return clock_; }
  [[nodiscard]] const ReceiverPosition& position() const { return position_; }

  [[nodiscard]] const OemStream& stream() const { return stream_; }
  [[nodiscard]] const ReceiverCounters& counters() const { return counters_; }

 private:
  ReceiverUpdate read(const OemMessage& message);
  ReceiverUpdate evaluate(Status status, ReceiverUpdate update);
  template <class T>
  ReceiverUpdate keep(const Result<T>& result, T& place, ReceiverUpdate update);

  OemStream stream_;
  ReceiverCounters counters_;
  ObservationEpoch observations_;
  Ephemeris ephemeris_;
  KlobucharCoefficients ionosphere_;
  ReceiverClock clock_;
  ReceiverPosition position_;
};

// The decoders of both receivers' bytes.

enum class Receiver : std::uint8_t { kServicer = 0, kTarget = 1 };

class ReceiverDecoders {
 public:
  /// Passes what the packets of the step complete to `on_epoch(receiver, epoch)` and `on_ephemeris(ephemeris)`. A
  /// packet with a count beyond its array is counted in the inbox and skipped.
  template <class OnEpoch, class OnEphemeris>
  void decode(messaging::Inbox& inbox, OnEpoch&& on_epoch, OnEphemeris&& on_ephemeris) {
    decode_one(Receiver::kServicer, inbox.queue<vbar::gnss_bytes>(), inbox, on_epoch, on_ephemeris);
    decode_one(Receiver::kTarget, inbox.queue<vbar::crosslink_gnss_bytes>(), inbox, on_epoch, on_ephemeris);
  }

  /// Complete messages of both receivers, and those refused because of checksum or contents.
  [[nodiscard]] std::int32_t messages() const;
  [[nodiscard]] std::int32_t refused() const;

 private:
  template <class Queue, class OnEpoch, class OnEphemeris>
  void decode_one(Receiver receiver, const Queue& packets, messaging::Inbox& inbox, OnEpoch& on_epoch,
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

}  // namespace vbar::fsw::gnss
