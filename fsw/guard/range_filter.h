#pragma once
// Range and range rate of the safety monitor: an alpha-beta filter of the logarithm of the range, without a covariance.
// Attitude and phase of the target change its apparent size by a third within minutes, hence the memory of minutes.

#include "fsw/core/gps_time.h"

namespace vbar::fsw::guard {

class RangeFilter {
 public:
  /// Adds a range, m, at `time`. A range that is not later than the last one is ignored.
  void add(GpsTime time, double range_m);

  [[nodiscard]] bool is_known() const { return samples_ > 0; }
  /// Returns whether the data span twice the memory, so that the rate is valid.
  [[nodiscard]] bool has_rate() const { return seconds(last_ - first_) > 2.0 * kMemory_s; }
  [[nodiscard]] GpsTime last() const { return last_; }
  [[nodiscard]] double range_m(GpsTime time) const;
  [[nodiscard]] double range_rate(GpsTime time) const { return range_m(time) * rate_; }  ///< m/s

  static constexpr double kMemory_s = 300.0;
  /// Longest gap: after a longer one the filter is re-initialised by the next range.
  static constexpr double kLongestGap_s = 600.0;

 private:
  GpsTime first_;
  GpsTime last_;
  int samples_ = 0;
  double logarithm_ = 0.0;  ///< logarithm of the range in m
  double rate_ = 0.0;       ///< rate of the logarithm, 1/s
};

}  // namespace vbar::fsw::guard
