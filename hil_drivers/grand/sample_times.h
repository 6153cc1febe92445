#pragma once
// Times at which the samples of the trajectory are sent: their lead on the generator's time, late and missing ones.

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>

#include "fsw/core/gps_time.h"

namespace vbar::grand {

class SampleTimes {
 public:
  explicit SampleTimes(fsw::Duration period) : period_(period) {}

  struct Second {
    std::int64_t samples = 0, late = 0, missing = 0;
    std::optional<double> lead_min_ms;
    double lead_sum_ms = 0.0;
  };

  /// Records a sample for `time` that follows one for `before` (below zero: none). `lead` is its own time before the
  /// generator's; empty in lock-step.
  void add(fsw::Duration time, fsw::Duration before, std::optional<fsw::Duration> lead) {
    ++second_.samples;
    if (before.ns >= 0) second_.missing += std::max<std::int64_t>(0, (time.ns - before.ns) / period_.ns - 1);
    if (!lead) return;
    const double lead_ms = 1e3 * fsw::seconds(*lead);
    if (lead_ms < 0.0) ++second_.late;
    second_.lead_min_ms = std::min(second_.lead_min_ms.value_or(lead_ms), lead_ms);
    second_.lead_sum_ms += lead_ms;
  }

  /// Returns the figures since the last call of this function.
  [[nodiscard]] Second take() { return std::exchange(second_, {}); }

 private:
  fsw::Duration period_;
  Second second_;
};

}  // namespace vbar::grand
