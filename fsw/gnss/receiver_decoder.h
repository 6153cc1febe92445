#pragma once
// Conversion of the bytes of one receiver to observations and ephemerides: the stream, its messages, their contents.

#include "fsw/core/result.h"
#include "fsw/gnss/ephemeris.h"
#include "fsw/gnss/observation.h"
#include "fsw/gnss/oem_range.h"
#include "fsw/gnss/oem_solution.h"
#include "fsw/gnss/oem_stream.h"

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

}  // namespace vbar::fsw::gnss
