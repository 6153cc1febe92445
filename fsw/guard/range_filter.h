#pragma once
// The guard's range and range rate: an alpha-beta filter of the logarithm of the range, without a covariance. Attitude
// and phase of the target change its size by a third within minutes, hence the memory of minutes.

#include "fsw/core/gps_time.h"

namespace vbar::fsw::guard {

class RangeFilter {
 public:
  /// A range, m, at `time`; one not later than the last is ignored.
  void add(GpsTime time, double range_m);

  [[nodiscard]] bool is_known() const { return samples_ > 0; }
  /// Whether the memory is filled, so that the rate means something.
  [[nodiscard]] bool has_rate() const { return seconds(last_ - first_) > 2.0 * kMemory_s; }
  [[nodiscard]] GpsTime last() const { return last_; }
  [[nodiscard]] double range_m(GpsTime time) const;
  [[nodiscard]] double range_rate(GpsTime time) const { return range_m(time) * rate_; }  ///< m/s

  static constexpr double kMemory_s = 300.0;
  /// After a longer gap the filter begins with the next range.
  static constexpr double kLongestGap_s = 600.0;

 private:
  GpsTime first_;
  GpsTime last_;
  int samples_ = 0;
  double logarithm_ = 0.0;  ///< of the range in m
  double rate_ = 0.0;       ///< of the logarithm, 1/s
};

}  // namespace vbar::fsw::guard
