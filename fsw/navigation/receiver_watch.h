#pragma once
// The health of receivers, independent of their measurements: missing epochs, of the servicer's own receiver or over
// the crosslink.

#include <optional>

#include "fsw/core/gps_time.h"
#include "fsw/faults/fault_monitor.h"
#include "fsw/gnss/gnss_front_end.h"

namespace vbar::fsw::navigation {

class ReceiverWatch {
 public:
  /// Checks both receivers, after the packets of the step at `now` were decoded. A receiver without any epoch so far is
  /// not checked, nor one that is not in use. Time without steps does not count as silence.
  void update(GpsTime now, const gnss::GnssFrontEnd& gnss, bool uses_crosslink, faults::FaultMonitor& faults);

  /// Silence of the own receiver that is a fault, in epochs: they reach the flight software over a cable.
  static constexpr double kMissingEpochs = 2.0;
  /// Longest silence of the crosslink. Three lost epochs of ten seconds in a row exceed it: a crosslink that loses one
  /// in a hundred loses two in a row once a day.
  static constexpr Duration kLongestCrosslink = duration_of_seconds(30);

 private:
  /// Returns the seconds since the newest epoch of a receiver, or since packets were lost in a gap between steps.
  [[nodiscard]] double silent_s(GpsTime newest, GpsTime now) const;

  std::optional<GpsTime> last_step_;
  Duration step_interval_{0};             ///< interval between the last two steps
  std::optional<GpsTime> listens_since_;  ///< time of the step after a gap
};

}  // namespace vbar::fsw::navigation
