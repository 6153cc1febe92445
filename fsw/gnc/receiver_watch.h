#pragma once
// The health of receivers, as far as it shows without their measurements: epochs that stop coming, from the servicer's
// own receiver or over the crosslink.

#include <optional>

#include "fsw/core/gps_time.h"
#include "fsw/faults/fault_monitor.h"
#include "fsw/sources/gnss/gnss_front_end.h"

namespace vbar::fsw::gnc {

class ReceiverWatch {
 public:
  /// After the packets of the step at `now` were decoded. A receiver that has not been heard yet is not missed, nor one
  /// that is not used. Time in which no step was made does not count as silence.
  void update(GpsTime now, const sources::GnssFrontEnd& gnss, bool uses_crosslink, faults::FaultMonitor& faults);

  /// Epochs of the own receiver, which reach the flight software over a cable.
  static constexpr double kMissingEpochs = 2.0;
  /// Exceeded by three epochs of ten seconds in a row: a crosslink that loses one in a hundred loses two in a row once
  /// a day.
  static constexpr Duration kLongestCrosslink = duration_of_seconds(30);

 private:
  /// Seconds since the newest epoch of a receiver, or since packets were lost in a gap between steps.
  [[nodiscard]] double silent_s(GpsTime newest, GpsTime now) const;

  std::optional<GpsTime> last_step_;
  Duration step_interval_{0};             ///< between the last two steps
  std::optional<GpsTime> listens_since_;  ///< the step after a gap
};

}  // namespace vbar::fsw::gnc
