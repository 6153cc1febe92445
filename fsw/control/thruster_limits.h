#pragma once
// What a thruster can fly of a plan of impulses.
//
// A burn lasts, centred on its time. A larger one than the thruster can give is divided into equal ones, one or more
// revolutions earlier or later, at the same mean argument of latitude: each then changes relative semi-major axis,
// eccentricity and inclination vector as its share of the whole would (Gauss' variational equations at near-circular
// orbits; arrival.h: the effects of a burn depend on its argument of latitude, and only that on the mean longitude on
// its time too). The change of the mean longitude is corrected by the sizes of all burns (correction.h). What no
// revolution has room for is left to the next plan.
//
// The eccentricity and inclination vectors change by a burn through the angle 2 b by sin(b) / b of what an impulse
// changes them by: 0.5 % less in five minutes. The next plan contains that loss.

#include "fsw/control/plan.h"

namespace vbar::fsw::control {

struct ThrusterLimits {
  double acceleration = 0.0;  ///< m/s^2, thrust over mass; 0: burns are impulses, and all plans can be flown
  double minimum_dv = 0.0;    ///< m/s
  double maximum_dv = 0.0;    ///< m/s, above minimum_dv
  Duration pause{};           ///< least time from the end of a burn to the begin of the next

  [[nodiscard]] bool are_impulses() const { return !(acceleration > 0.0); }
  /// Returns the duration of a burn; 0 of an impulse.
  [[nodiscard]] Duration duration_of(const Vector3& dv) const;
  /// Returns when a burn is over: an impulse at its time.
  [[nodiscard]] GpsTime end_of(const Burn& burn) const;
  /// Returns half of the duration of the largest burn.
  [[nodiscard]] Duration half_of_longest() const;
  /// Returns the time of a burn that begins as soon as possible after the end of `last`, whatever its size.
  [[nodiscard]] GpsTime after(const Burn& last) const;
};

/// States when the burns of a plan may be.
struct BurnSpan {
  GpsTime earliest;     ///< time of the first one
  GpsTime arrival;      ///< a pause after the end of the last one
  Duration revolution;  ///< of the mean argument of latitude, > 0
};

/// Returns whether the thruster can fly the plan as it is: with impulses always. Small burns are no obstacle.
[[nodiscard]] bool can_fly(const Plan& plan, const ThrusterLimits& limits, const BurnSpan& span);

/// Returns the plan with burns that can be flown, but for their minimum: those too close to each other are united,
/// those too large divided, with a margin of kCorrectionMargin for the correction of their sizes. A burn that would end
/// after the arrival is earlier.
[[nodiscard]] Plan divided(const Plan& plan, const ThrusterLimits& limits, const BurnSpan& span);

/// Returns the plan with burns of at most the maximum.
[[nodiscard]] Plan limited(const Plan& plan, const ThrusterLimits& limits);

/// Returns the plan without the burns below the minimum.
[[nodiscard]] Plan without_small_burns(const Plan& plan, const ThrusterLimits& limits);

/// Returns the burns, in order of time, that are not over at `now`; of one that is under way the rest, as a burn of its
/// own. Impulses remain at `now` and later.
[[nodiscard]] Plan remaining(const Plan& plan, const ThrusterLimits& limits, GpsTime now);

/// Share of the maximum that the parts of a divided burn leave to the correction.
inline constexpr double kCorrectionMargin = 0.05;

}  // namespace vbar::fsw::control
