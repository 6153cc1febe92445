#pragma once
// Comparison of a receiver's time tags with the time of the run: receivers count weeks modulo 1024 and add a constant
// of their firmware, and a scenario may have been started at another time.

#include <optional>
#include <string>

#include "fsw/core/gps_time.h"

namespace vbar::grand {

class TagCheck {
 public:
  /// `receiver` begins the messages: "receiver of servicer on /dev/ttyUSB0". `max_latency` is that of the first epoch;
  /// below a second it shows a scenario that is off by one second in either direction.
  TagCheck(std::string receiver, bool accepts_week_shift, fsw::Duration max_latency)
      : receiver_(std::move(receiver)), accepts_week_shift_(accepts_week_shift), max_latency_(max_latency) {}

  /// Checks an epoch whose status is FINE or better, and whose last byte arrived at `arrival`. Throws
  /// std::runtime_error, one sentence, if its time is not the run's.
  void check(fsw::GpsTime tag, fsw::GpsTime arrival);

  /// Number of weeks to be added to the receiver's; 0 before the first tag.
  [[nodiscard]] int weeks() const { return weeks_.value_or(0); }
  [[nodiscard]] bool has_checked() const { return weeks_.has_value(); }

 private:
  std::string receiver_;
  bool accepts_week_shift_;
  fsw::Duration max_latency_;
  std::optional<int> weeks_;
};

}  // namespace vbar::grand
