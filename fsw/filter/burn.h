#pragma once
// Burns of the servicer: impulses, or a constant acceleration in its rotating RTN over an interval.
//
// The execution error of a burn, of variance s^2 per axis, is spread over its duration T as a white acceleration with
// the power spectral density s^2 / T: the velocity after the burn has the variance s^2, however the interval is divided
// by measurements.

#include <cstdint>
#include <span>

#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"

namespace vbar::fsw::filter {

/// A burn of the servicer, executed or commanded.
struct Burn {
  GpsTime time;  ///< of an impulse; the middle of a burn that lasts
  Vector3 dv_rtn =
      Vector3::Zero();            ///< m/s, in its RTN: before an impulse, rotating with the orbit in a burn that lasts
  Duration duration{};            ///< 0: an impulse
  std::int64_t maneuver_id = -1;  ///< of the command

  [[nodiscard]] constexpr bool lasts() const { return duration.ns > 0; }
  [[nodiscard]] constexpr GpsTime begin() const { return time - Duration{duration.ns / 2}; }
  [[nodiscard]] constexpr GpsTime end() const { return begin() + duration; }
  /// Returns whether the burn changes a state at `epoch`, which is one before any impulse of that instant.
  [[nodiscard]] constexpr bool acts_on(GpsTime epoch) const { return lasts() ? end() > epoch : time >= epoch; }
};

/// Holds 1-sigma execution errors, per axis of a burn.
struct BurnErrors {
  double sigma = 0.0;           ///< m/s
  double sigma_relative = 0.0;  ///< share of the size of the burn

  [[nodiscard]] double of(const Vector3& dv) const;
};

/// Holds the thrust of an interval in which no burn begins or ends.
struct Thrust {
  Vector3 acceleration_rtn = Vector3::Zero();  ///< m/s^2, rotates with the orbit
  double psd = 0.0;                            ///< m^2/s^3, per axis: execution errors as a white acceleration
  bool is_on = false;
};

/// Returns the thrust from `time` on; impulses give none.
[[nodiscard]] Thrust thrust_from(std::span<const Burn> burns, GpsTime time, const BurnErrors& errors = {});

/// Returns the earliest begin or end after `time` of a burn that lasts, at most `until`.
[[nodiscard]] GpsTime next_edge(std::span<const Burn> burns, GpsTime time, GpsTime until);

/// Returns `reported`, a report on `commanded`, as it has to act on a state at `epoch` that holds the first part of the
/// command: what the report makes of that part is added to the rest.
[[nodiscard]] Burn as_reported(const Burn& commanded, const Burn& reported, GpsTime epoch);

}  // namespace vbar::fsw::filter
