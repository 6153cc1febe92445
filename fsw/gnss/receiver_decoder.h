#pragma once
// From the bytes of one receiver's line to what they tell, one thing at a time: the stream, its messages, their
// contents.

#include "fsw/core/result.h"
#include "fsw/gnss/ephemeris.h"
#include "fsw/gnss/observation.h"
#include "fsw/gnss/oem_range.h"
#include "fsw/gnss/oem_solution.h"
#include "fsw/gnss/oem_stream.h"

namespace vbar::fsw::gnss {

/// What a byte completed.
enum class ReceiverUpdate : std::uint8_t {
  kNone = 0,
  kObservations,
  kEphemeris,
  kIonosphere,
  kClock,
  kPosition,
};

struct ReceiverCounters {
  std::uint32_t unknown = 0;    ///< whole messages that are not read here, answers and other antennas' included
  std::uint32_t not_ready = 0;  ///< messages in which the receiver says that it does not know yet
  std::uint32_t refused = 0;    ///< messages whose contents cannot be
  ObservationTally observations;
};

/// All of it is plain state, so a copy decodes on as the original does.
class ReceiverDecoder {
 public:
  /// Takes one byte. What it says was updated can be read until the next push.
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
  ReceiverUpdate judge(Status status, ReceiverUpdate update);
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
